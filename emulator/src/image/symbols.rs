//! Names in an image, for messages and for looking at its variables.

/// What a symbol stands for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum SymbolKind {
    /// A bare address, usually set by the linker script, such as `__sbss`.
    Mark,
    /// A variable or constant.
    Object,
    /// Code.
    Function,
}

/// A named address.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Symbol {
    /// Where it is; for code without the Thumb bit.
    pub address: u32,
    /// Its size (bytes); 0 if the file does not say.
    pub size: u32,
    /// What it stands for.
    pub kind: SymbolKind,
    /// Its name as it reads in the source, without the compiler's hash.
    pub name: String,
}

/// The symbols of an image in the order of their addresses.
#[derive(Debug, Clone, Default)]
pub struct Symbols {
    sorted: Vec<Symbol>,
}

impl Symbols {
    pub(super) fn new(mut symbols: Vec<Symbol>) -> Self {
        symbols.sort_by(|a, b| {
            (a.address, a.kind, a.size, &b.name).cmp(&(b.address, b.kind, b.size, &a.name))
        });
        Self { sorted: symbols }
    }

    /// Whether there are no names.
    pub fn is_empty(&self) -> bool {
        self.sorted.is_empty()
    }

    /// The symbols in the order of their addresses.
    pub fn iter(&self) -> std::slice::Iter<'_, Symbol> {
        self.sorted.iter()
    }

    /// The function or object that `address` lies in, and how far into it.
    pub(super) fn at(&self, address: u32) -> Option<(&str, u32)> {
        let behind = self
            .sorted
            .partition_point(|symbol| symbol.address <= address);
        let symbol = self.sorted[..behind]
            .iter()
            .rev()
            .find(|symbol| symbol.kind != SymbolKind::Mark)?;
        let offset = address - symbol.address;
        // Assembly routines often have no size; they reach to the next symbol.
        (symbol.size == 0 || offset < symbol.size).then_some((symbol.name.as_str(), offset))
    }

    /// The one address of the symbols whose path ends in `path`.
    pub(super) fn address_of(&self, path: &str) -> Option<u32> {
        let ends = |name: &str| {
            name.strip_suffix(path)
                .is_some_and(|before| before.is_empty() || before.ends_with("::"))
        };
        let mut found = self
            .sorted
            .iter()
            .filter(|symbol| ends(&symbol.name))
            .map(|symbol| symbol.address);
        let first = found.next()?;
        found.all(|address| address == first).then_some(first)
    }
}
