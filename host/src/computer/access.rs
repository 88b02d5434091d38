//! Whether a port may be opened by whoever runs this, without opening it: some boards start anew when
//! somebody does.

/// What keeps somebody from it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Barrier {
    /// The group that would be let in, if there is one that everybody can join.
    pub group: Option<String>,
}

/// What keeps us from reading and writing this file; nothing where that is not known.
#[cfg(unix)]
pub fn barrier(path: &str) -> Option<Barrier> {
    use std::fs;
    use std::os::unix::fs::MetadataExt;

    let file = fs::metadata(path).ok()?;
    let identity = Identity::parse(&fs::read_to_string("/proc/self/status").ok()?)?;
    if identity.may(file.mode(), file.uid(), file.gid()) {
        return None;
    }
    let group_lets_in = file.mode() & 0o060 == 0o060 && file.gid() != 0;
    let groups = fs::read_to_string("/etc/group").unwrap_or_default();
    Some(Barrier {
        group: group_lets_in
            .then(|| group_name(&groups, file.gid()))
            .flatten(),
    })
}

/// What keeps us from reading and writing this file; nothing where that is not known.
#[cfg(not(unix))]
pub fn barrier(_path: &str) -> Option<Barrier> {
    None
}

/// Who we are to the file system.
#[cfg(unix)]
struct Identity {
    user: u32,
    groups: Vec<u32>,
}

#[cfg(unix)]
impl Identity {
    /// From `/proc/self/status`: the effective numbers are the second.
    fn parse(status: &str) -> Option<Self> {
        let numbers = |name: &str| {
            let line = status.lines().find_map(|line| line.strip_prefix(name))?;
            line.split_whitespace()
                .map(|word| word.parse().ok())
                .collect::<Option<Vec<u32>>>()
        };
        let mut groups = numbers("Groups:")?;
        groups.push(*numbers("Gid:")?.get(1)?);
        Some(Self {
            user: *numbers("Uid:")?.get(1)?,
            groups,
        })
    }

    /// The first that fits decides, and the superuser may anything.
    fn may(&self, mode: u32, owner: u32, group: u32) -> bool {
        let bits = if self.user == owner {
            mode >> 6
        } else if self.groups.contains(&group) {
            mode >> 3
        } else {
            mode
        };
        self.user == 0 || bits & 0o6 == 0o6
    }
}

/// From `/etc/group`.
#[cfg(unix)]
fn group_name(groups: &str, number: u32) -> Option<String> {
    groups.lines().find_map(|line| {
        let mut fields = line.split(':');
        let name = fields.next()?;
        (fields.nth(1)?.parse() == Ok(number)).then(|| name.to_owned())
    })
}

#[cfg(all(test, unix))]
mod tests {
    use super::{Identity, group_name};

    const STATUS: &str = "Name:\tx\nUid:\t1000\t1000\t1000\t1000\nGid:\t1000\t1000\t1000\t1000\nGroups:\t20 27 1000 \n";

    #[test]
    fn owner_group_and_others_are_told_apart() {
        let me = Identity::parse(STATUS).unwrap();
        assert!(me.may(0o660, 0, 20), "of the group");
        assert!(!me.may(0o660, 0, 5), "of another group");
        assert!(me.may(0o666, 0, 5), "anybody");
        assert!(me.may(0o600, 1000, 0), "its owner");
        assert!(!me.may(0o066, 1000, 20), "the owner is nobody else");
        let root = Identity::parse(&STATUS.replace("1000", "0")).unwrap();
        assert!(root.may(0o600, 1, 1));
        assert!(Identity::parse("Uid:\tx\n").is_none());
    }

    #[test]
    fn a_group_has_a_name() {
        let groups = "root:x:0:\ndialout:x:20:ada\nplugdev:x:46:\n";
        assert_eq!(group_name(groups, 20).as_deref(), Some("dialout"));
        assert_eq!(group_name(groups, 2), None);
    }
}
