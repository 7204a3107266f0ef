//! Symmetric and asymmetric orbits at K = 0.14: Fig. 7.

use super::second::{MULTIPLIERS, orbit_at, second_method};
use super::{Answer, Entry, missing, range, stability_word, whether};
use crate::Pieces;
use twinslip::bifurcation::BranchRow;
use twinslip::equilibrium::{Symmetry, Verdict};
use twinslip::error::Result;
use twinslip::orbit::InitialGuess;

/// V_H between which both kinds of orbits are compared, away from the Hopf points where the symmetric ones vanish.
const COMPARED: (f64, f64) = (0.2, 100.0);
/// Periods are very similar if Fig. 7(b), with its logarithmic axis, has them within this part of its height.
const SIMILAR: f64 = 0.05;

/// All of it.
pub fn entries(pieces: &Pieces<'_>) -> Result<Vec<Entry>> {
    let branches = pieces.branches("fig07")?;
    let rows = branches.rows.iter();
    let (symmetric, asymmetric): (Vec<_>, Vec<_>) =
        rows.partition(|row| row.state[0] == row.state[1]);
    let pairs = neighbours(&symmetric, &asymmetric);
    if pairs.is_empty() {
        return Err(missing("fig07 has no orbits of both kinds"));
    }
    Ok(vec![
        across(pieces, &symmetric)?,
        amplitudes(&pairs),
        periods(&pairs),
    ])
}

fn across(pieces: &Pieces<'_>, symmetric: &[&BranchRow]) -> Result<Entry> {
    let unstable = symmetric.iter().all(|row| row.verdict == Verdict::Unstable);
    let within = symmetric
        .iter()
        .all(|row| row.ln_abs_multiplier[1].is_some_and(|x| x < 0.0));
    let (at, kind) = ((1.0, 0.14), Symmetry::Symmetric);
    let again = orbit_at(pieces, at, kind, InitialGuess::Anywhere, second_method()?)?;
    let logarithm = |i: usize| {
        let one = again.floquet.multipliers.get(i);
        one.map_or(f64::NAN, |one| one.ln_abs.value)
    };
    Ok(Entry::claim(
        ("symmetric-orbits-across", "section 4.2; Fig. 7"),
        "the symmetric orbits at K = 0.14 against asymmetric perturbations",
        "unstable",
        whether(unstable, "unstable", "not always unstable"),
    )
    .beside(MULTIPLIERS, Answer::Word(stability_word(again.verdict())))
    .noted(format!(
        "at V_H = 1 ln |mu| = {:.6} and {:.6}; within the subspace psi_1 = psi_2 they are {}, \
         which the text says too",
        logarithm(0),
        logarithm(1),
        whether(within, "all stable", "not all stable")
    )))
}

/// Amplitude of stress and period.
type Shape = [f64; 2];

fn shape(row: &BranchRow) -> Shape {
    let amplitude = row.stress_range.1 - row.stress_range.0;
    [amplitude, row.period.unwrap_or(f64::NAN)]
}

/// The shapes of symmetric and asymmetric orbits of the same V_H.
fn neighbours(symmetric: &[&BranchRow], asymmetric: &[&BranchRow]) -> Vec<[Shape; 2]> {
    let compared = COMPARED.0..=COMPARED.1;
    let inside = asymmetric
        .iter()
        .filter(|row| compared.contains(&row.driving));
    let pairs = inside.filter_map(|row| Some([between(symmetric, row.driving)?, shape(row)]));
    pairs.collect()
}

/// The shape at this V_H, from the neighbours on the branch.
fn between(rows: &[&BranchRow], driving: f64) -> Option<Shape> {
    let pair = rows.windows(2).find(|pair| {
        let (a, b) = (pair[0].driving, pair[1].driving);
        pair[0].branch == pair[1].branch && a <= driving && driving < b
    })?;
    let part = (driving / pair[0].driving).ln() / (pair[1].driving / pair[0].driving).ln();
    let (here, there) = (shape(pair[0]), shape(pair[1]));
    Some([0, 1].map(|i| here[i] * (1.0 - part) + there[i] * part))
}

fn amplitudes(pairs: &[[Shape; 2]]) -> Entry {
    let (least, most) = range(pairs.iter().map(|[s, a]| a[0] / s[0]));
    Entry::claim(
        ("amplitudes-at-0.14", "section 4.2; Fig. 7"),
        "the amplitudes of stress of the asymmetric orbits beside the symmetric ones, K = 0.14",
        "smaller",
        whether(most < 1.0, "smaller", "not always smaller"),
    )
    .noted(format!(
        "their ratio is {least:.3} to {most:.3} from V_H = {} to {}; nearer to the Hopf points \
         where they vanish the symmetric orbits are the smaller ones",
        COMPARED.0, COMPARED.1
    ))
}

fn periods(pairs: &[[Shape; 2]]) -> Entry {
    let (least, most) = range(pairs.iter().map(|[s, a]| a[1] / s[1]));
    let (shortest, longest) = range(pairs.iter().flat_map(|[s, a]| [s[1], a[1]]));
    let part = least.ln().abs().max(most.ln().abs()) / (longest / shortest).ln();
    Entry::claim(
        ("periods-at-0.14", "section 4.2; Fig. 7(b)"),
        "the periods of symmetric and asymmetric orbits, K = 0.14",
        "very similar",
        whether(part < SIMILAR, "very similar", "unlike"),
    )
    .noted(format!(
        "the ratio of the asymmetric to the symmetric one is {least:.3} to {most:.3} from V_H = {} \
         to {}, where they fall from {longest:.0} to {shortest:.2}: on the logarithmic axis of the \
         figure they differ by at most the part {part:.3} of that",
        COMPARED.0, COMPARED.1
    ))
}
