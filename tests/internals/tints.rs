//! Colours of regimes.

use twinslip_output::plot::Shade;
use twinslip_tasks::views::sweep::tints::{LIGHTEST, RegimeKind};
const ALL: [RegimeKind; 11] = [
    RegimeKind::SteadySymmetric,
    RegimeKind::SteadyAsymmetric,
    RegimeKind::PeriodicSymmetric,
    RegimeKind::PeriodicAsymmetric,
    RegimeKind::Period2,
    RegimeKind::Period3,
    RegimeKind::Period4,
    RegimeKind::PeriodHigher,
    RegimeKind::Torus,
    RegimeKind::Chaotic,
    RegimeKind::Undecided,
];

/// Linear light of the parts of a colour (IEC 61966-2-1).
fn light(shade: Shade) -> [f64; 3] {
    shade.colour.map(|part| {
        let part = f64::from(part);
        let part = (part + shade.lightness * (255.0 - part)) / 255.0;
        if part <= 0.04045 {
            part / 12.92
        } else {
            ((part + 0.055) / 1.055).powf(2.4)
        }
    })
}

/// L* of CIE 1976.
fn lightness([r, g, b]: [f64; 3]) -> f64 {
    let y = 0.2126 * r + 0.7152 * g + 0.0722 * b;
    if y > 0.008856 {
        116.0 * y.cbrt() - 16.0
    } else {
        903.3 * y
    }
}

/// What eyes without one kind of cones see (Machado, Oliveira and Fernandes 2009, severity 1).
const SEEN: [[[f64; 3]; 3]; 3] = [
    [
        [0.152286, 1.052583, -0.204868],
        [0.114503, 0.786281, 0.099216],
        [-0.003882, -0.048116, 1.051998],
    ],
    [
        [0.367322, 0.860646, -0.227968],
        [0.280085, 0.672501, 0.047413],
        [-0.011820, 0.042940, 0.968881],
    ],
    [
        [1.255528, -0.076749, -0.178779],
        [-0.078411, 0.930809, 0.147602],
        [0.004733, 0.691367, 0.303900],
    ],
];

#[test]
fn regimes_are_told_apart_in_grey() {
    let mut shades = ALL.map(RegimeKind::shade).to_vec();
    let palest = RegimeKind::Chaotic.shade().lighter(LIGHTEST);
    shades.push(palest);
    for (i, &a) in shades.iter().enumerate() {
        for &b in &shades[..i] {
            let apart = (lightness(light(a)) - lightness(light(b))).abs();
            assert!(apart > 5.0, "{a:?} and {b:?}: {apart}");
        }
    }
}

/// Euclidean distance in L*a*b*, where 2.3 can just be seen.
#[test]
fn the_colour_blind_tell_them_apart() {
    let lab = |[r, g, b]: [f64; 3]| {
        let f = |t: f64| {
            if t > 0.008856 {
                t.cbrt()
            } else {
                7.787 * t + 16.0 / 116.0
            }
        };
        let x = f((0.4124 * r + 0.3576 * g + 0.1805 * b) / 0.95047);
        let y = f(0.2126 * r + 0.7152 * g + 0.0722 * b);
        let z = f((0.0193 * r + 0.1192 * g + 0.9505 * b) / 1.08883);
        [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
    };
    const ALL_CONES: [[f64; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    for seen in SEEN.into_iter().chain([ALL_CONES]) {
        let all = ALL.map(|kind| {
            let rgb = light(kind.shade());
            lab(seen
                .map(|row| (row[0] * rgb[0] + row[1] * rgb[1] + row[2] * rgb[2]).clamp(0.0, 1.0)))
        });
        for (i, a) in all.iter().enumerate() {
            for (j, b) in all[..i].iter().enumerate() {
                let apart = (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>().sqrt();
                assert!(apart > 16.0, "{:?} and {:?}: {apart}", ALL[i], ALL[j]);
            }
        }
    }
}
