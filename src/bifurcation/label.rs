//! What points on branches and curves are.

/// What a point is, in AUTO's letters where AUTO has them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Label {
    /// Pitchfork or branch point of equilibria.
    Bp,
    /// Fold of equilibria.
    Lp,
    /// Hopf point.
    Hb,
    /// Period doubling.
    Pd,
    /// Torus (Neimark-Sacker).
    Tr,
    /// Pitchfork of periodic orbits: a symmetric orbit meets asymmetric ones.
    Pf,
    /// Fold (saddle-node) of periodic orbits.
    Sn,
    /// A value that was asked for.
    Uz,
    /// A zero of the user's function.
    Uf,
    /// The end of the range, or of the branch.
    Ep,
    /// No further: the method failed here.
    Mx,
    /// The end of a branch of orbits whose period grows without bound, at a homoclinic orbit.
    Hom,
    /// Strong resonance 1:1.
    R1,
    /// Strong resonance 1:2.
    R2,
    /// Strong resonance 1:3.
    R3,
    /// Strong resonance 1:4.
    R4,
    /// Degenerate (generalised) Hopf point: the first Lyapunov coefficient is zero.
    Gh,
    /// Chenciner point: the cubic coefficient of the torus bifurcation is zero.
    Ch,
    /// Degenerate period doubling: its cubic coefficient is zero.
    Gpd,
    /// Cusp; on a curve of pitchforks the degenerate pitchfork where a fold curve ends.
    Cp,
    /// Bogdanov-Takens point.
    Bt,
    /// Zero-Hopf point.
    Zh,
    /// Double Hopf point: a second pair of eigenvalues is on the imaginary axis.
    Hh,
    /// Orbits with the multipliers 1 and -1.
    Ff,
    /// Orbits with the multiplier 1 and a pair on the unit circle.
    Fn,
    /// Orbits with two pairs on the unit circle.
    Nn,
    /// Orbits with the multiplier -1 and a pair on the unit circle.
    Pn,
    /// The largest K of a curve.
    Top,
    /// Homoclinic orbits to a neutral saddle, saddle-focus or bi-focus: the saddle quantity is zero.
    Nss,
    /// See [`Label::Nss`].
    Nsf,
    /// See [`Label::Nss`].
    Nff,
    /// The two leading stable eigenvalues are equal.
    Drs,
    /// The two leading unstable eigenvalues are equal.
    Dru,
    /// Of the three leading stable eigenvalues all have the same real part.
    Tls,
    /// The same of the unstable ones.
    Tlu,
    /// The divergence is zero in the leading directions of a saddle-focus, of which a pair is stable.
    Nds,
    /// The same where it is unstable.
    Ndu,
    /// Orbit flip: the orbit arrives along another direction than the leading one.
    Ofs,
    /// Orbit flip: the orbit leaves along another direction than the leading one.
    Ofu,
    /// Inclination flip of the stable manifold.
    Ifs,
    /// Inclination flip of the unstable manifold.
    Ifu,
    /// A non-central homoclinic orbit to a saddle-node: one end of the curve of orbits that are homoclinic to a saddle.
    Nch,
}

/// Each with its name in tables and what it means, in the order of their declaration.
const TABLE: [(Label, &str, &str); 42] = [
    (Label::Bp, "BP", "pitchfork"),
    (Label::Lp, "LP", "saddle-node"),
    (Label::Hb, "HB", "Hopf"),
    (Label::Pd, "PD", "period doubling"),
    (Label::Tr, "TR", "torus"),
    (Label::Pf, "PF", "pitchfork of orbits"),
    (Label::Sn, "SN", "saddle-node of orbits"),
    (Label::Uz, "UZ", "value asked for"),
    (Label::Uf, "UF", "user function"),
    (Label::Ep, "EP", "end"),
    (Label::Mx, "MX", "no further"),
    (Label::Hom, "HOM", "homoclinic"),
    (Label::R1, "R1", "resonance 1:1"),
    (Label::R2, "R2", "resonance 1:2"),
    (Label::R3, "R3", "resonance 1:3"),
    (Label::R4, "R4", "resonance 1:4"),
    (Label::Gh, "GH", "degenerate Hopf"),
    (Label::Ch, "CH", "Chenciner"),
    (Label::Gpd, "GPD", "degenerate period doubling"),
    (Label::Cp, "CP", "cusp"),
    (Label::Bt, "BT", "Bogdanov-Takens"),
    (Label::Zh, "ZH", "zero-Hopf"),
    (Label::Hh, "HH", "double Hopf"),
    (Label::Ff, "FF", "fold-flip"),
    (Label::Fn, "FN", "fold-Neimark-Sacker"),
    (Label::Nn, "NN", "double Neimark-Sacker"),
    (Label::Pn, "PN", "flip-Neimark-Sacker"),
    (Label::Top, "TOP", "largest stiffness"),
    (Label::Nss, "NSS", "neutral saddle"),
    (Label::Nsf, "NSF", "neutral saddle-focus"),
    (Label::Nff, "NFF", "neutral bi-focus"),
    (Label::Drs, "DRS", "double real stable eigenvalues"),
    (Label::Dru, "DRU", "double real unstable eigenvalues"),
    (Label::Tls, "TLS", "three leading stable eigenvalues"),
    (Label::Tlu, "TLU", "three leading unstable eigenvalues"),
    (
        Label::Nds,
        "NDS",
        "neutrally divergent saddle-focus, stable",
    ),
    (
        Label::Ndu,
        "NDU",
        "neutrally divergent saddle-focus, unstable",
    ),
    (Label::Ofs, "OFS", "orbit flip, stable"),
    (Label::Ofu, "OFU", "orbit flip, unstable"),
    (Label::Ifs, "IFS", "inclination flip, stable"),
    (Label::Ifu, "IFU", "inclination flip, unstable"),
    (Label::Nch, "NCH", "non-central homoclinic to a saddle-node"),
];

impl Label {
    /// All, in the order of their declaration.
    pub const ALL: [Label; TABLE.len()] = {
        let mut all = [Label::Bp; TABLE.len()];
        let mut i = 0;
        while i < TABLE.len() {
            all[i] = TABLE[i].0;
            i += 1;
        }
        all
    };

    /// The bifurcations of one parameter.
    pub const BIFURCATIONS: [Label; 7] = [
        Label::Bp,
        Label::Lp,
        Label::Hb,
        Label::Pd,
        Label::Tr,
        Label::Pf,
        Label::Sn,
    ];

    /// The label of that name.
    pub fn named(name: &str) -> Option<Label> {
        Label::ALL.into_iter().find(|label| label.name() == name)
    }

    /// As tables write it.
    pub fn name(self) -> &'static str {
        TABLE[self as usize].1
    }

    /// In words.
    pub fn meaning(self) -> &'static str {
        TABLE[self as usize].2
    }
}

#[cfg(test)]
mod test {
    use super::*;

    #[test]
    fn each_has_its_own_row() {
        for (i, label) in Label::ALL.into_iter().enumerate() {
            assert_eq!(label as usize, i, "{label:?}");
            assert_eq!(Label::named(label.name()), Some(label));
        }
    }
}
