//! Every filter speaks our conventions: level, north and a turn come out where they are.

use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use vrduino_accuracy_peers::{PEERS, Peer, Sample};

/// No filter's own default, so that a period that is not passed on shows as a wrong turn.
const PERIOD_S: f64 = 1.0 / 200.0;
/// Long enough for the slowest: Mahony brings the heading home with a time constant of 8 s.
const STILL_S: f64 = 90.0;
const TURN_S: f64 = 2.0;

/// Where the body lies at first: neither level nor pointing north, each axis told from the others.
fn attitude() -> UnitQuaternion<f64> {
    UnitQuaternion::from_euler_angles(0.3, -0.5, 0.9)
}

/// A turn of more than half a circle in all, about no particular axis of the body, rad/s.
fn turn() -> Vector3<f64> {
    Vector3::new(0.6, -1.1, 1.4)
}

/// What the sensors read: gravity is up, the field points north and down.
fn sample(body_to_world: UnitQuaternion<f64>, rate: Vector3<f64>) -> Sample {
    let seen = |world: Vector3<f64>| body_to_world.inverse_transform_vector(&world);
    Sample {
        rate: rate.into(),
        force: seen(Vector3::new(0.0, 0.0, 9.81)).into(),
        field: seen(Vector3::new(0.0, 25.0, -25.0)).into(),
    }
}

/// Still, then the turn: the true orientation after each sample, and the samples.
fn motion() -> (Vec<UnitQuaternion<f64>>, Vec<Sample>) {
    let still = (STILL_S / PERIOD_S) as usize;
    let turning = (TURN_S / PERIOD_S) as usize;
    let mut truth = vec![attitude(); still];
    let mut samples = vec![sample(attitude(), Vector3::zeros()); still];
    for step in 1..=turning {
        let turned = UnitQuaternion::new(turn() * (step as f64 * PERIOD_S));
        truth.push(attitude() * turned);
        samples.push(sample(attitude() * turned, turn()));
    }
    (truth, samples)
}

/// The errors in the world, `estimate * truth⁻¹`, at the end of the still time and of the turn.
fn errors(peer: &Peer) -> [UnitQuaternion<f64>; 2] {
    let (truth, samples) = motion();
    let estimates = peer.run(PERIOD_S, &samples);
    assert_eq!(estimates.len(), samples.len(), "{}", peer.name);
    let before_the_turn = (STILL_S / PERIOD_S) as usize - 1;
    [before_the_turn, samples.len() - 1].map(|at| {
        let [w, x, y, z] = estimates[at];
        UnitQuaternion::from_quaternion(Quaternion::new(w, x, y, z)) * truth[at].inverse()
    })
}

#[test]
fn every_peer_finds_level() {
    for peer in PEERS {
        let [still, _] = errors(&peer);
        let tilt = (still * Vector3::z()).angle(&Vector3::z()).to_degrees();
        assert!(tilt < 0.5, "{}: {tilt:.2}° from level", peer.name);
    }
}

#[test]
fn every_peer_with_nine_axes_finds_north() {
    for peer in PEERS.iter().filter(|peer| peer.axes == 9) {
        let [still, _] = errors(peer);
        let off = still.angle().to_degrees();
        assert!(off < 0.5, "{}: {off:.2}° off", peer.name);
    }
}

#[test]
fn every_peer_follows_a_turn() {
    for peer in PEERS {
        let [before, after] = errors(&peer);
        let lost = before.angle_to(&after).to_degrees();
        // A filter that corrects before it integrates looks at a force one sample ahead of itself:
        // at this rate 0.54°, towards which the quick ones creep.
        assert!(lost < 1.0, "{}: {lost:.2}° lost in the turn", peer.name);
    }
}

#[test]
fn the_bias_correction_of_fusion_takes_a_constant_rate_away() {
    // 1 °/s about up: what is left of it in the last 10 s.
    let level = UnitQuaternion::identity();
    let biased = sample(level, Vector3::new(0.0, 0.0, 1.0_f64.to_radians()));
    let samples = vec![biased; (STILL_S / PERIOD_S) as usize];
    let turned = |name: &str| {
        let peer = PEERS.iter().find(|peer| peer.name == name).unwrap();
        let estimates = peer.run(PERIOD_S, &samples);
        let heading = |[w, _, _, z]: [f64; 4]| 2.0 * z.atan2(w).to_degrees();
        let earlier = samples.len() - 1 - (10.0 / PERIOD_S) as usize;
        heading(estimates[samples.len() - 1]) - heading(estimates[earlier])
    };
    assert!((turned("fusion-6") - 10.0).abs() < 0.1);
    assert!(turned("fusion-bias-6").abs() < 0.1);
}

#[test]
fn a_peer_with_six_axes_does_not_look_at_the_field() {
    let (_, samples) = motion();
    let without: Vec<Sample> = samples
        .iter()
        .map(|sample| Sample {
            field: [0.0; 3],
            ..*sample
        })
        .collect();
    for peer in PEERS.iter().filter(|peer| peer.axes == 6) {
        let same = peer.run(PERIOD_S, &samples) == peer.run(PERIOD_S, &without);
        assert!(same, "{}", peer.name);
    }
}

#[test]
fn every_peer_has_a_name_of_its_own_and_names_the_pinned_version() {
    let manifest = include_str!("../Cargo.toml");
    for (at, peer) in PEERS.iter().enumerate() {
        assert!(
            PEERS[..at].iter().all(|other| other.name != peer.name),
            "{}",
            peer.name
        );
        let (name, version) = peer.source.split_once(' ').unwrap();
        let pin = format!("{name} = {{ version = \"={version}\"");
        assert!(
            manifest.contains(&pin),
            "{}: no {pin} in the manifest",
            peer.name
        );
    }
}
