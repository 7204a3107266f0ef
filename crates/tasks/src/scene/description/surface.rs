//! A section that the runs of a user-defined system cross.

use crate::scene::text::TextModel;
use std::cell::RefCell;
use twinslip::integrate::{AnyIntegrator, AnyStep, Choice, Control, Tolerances};

/// Steps of the run that is watched, of which the first half is let pass as a transient.
const STEPS: usize = 1200;
/// As long as a run may be, which ends by its steps, in the units in which the system moves by about 1.
const FOREVER: f64 = 1e30;
const TOLERANCE: f64 = 1e-6;
/// Values within a step.
const WITHIN: usize = 4;
/// A state that moves by less than this part of its unit does not move.
const STILL: f64 = 1e-3;
/// The middle is rounded to about this part of what the state moves by.
const ROUGH: f64 = 1e-2;

/// STATE=VALUE of the state whose middle a run from the system's own start crosses most often, of several the one that moves farthest in the
/// units in which the system moves by about 1; `None` where it comes to rest, or where there is no such run.
pub(super) fn surface(model: &TextModel) -> Option<String> {
    let start = model.start(None).ok()?;
    if start.len() < 2 {
        return None;
    }
    let units = model.motion_units_of_run(&start).ok()?;
    let field = units.field(&model.system).ok()?;
    let tolerances = Tolerances::equal(TOLERANCE).ok()?;
    let mut integrator = AnyIntegrator::new(Choice::Auto, tolerances, STEPS).ok()?;
    let seen: RefCell<Vec<Vec<f64>>> = RefCell::default();
    let mut steps = 0;
    let mut observer = |step: &AnyStep<'_>| {
        steps += 1;
        if steps > STEPS / 2 {
            let part = |i: usize| step.length * i as f64 / WITHIN as f64;
            let values = (0..WITHIN).map(|i| units.outward(&step.after(part(i))));
            let mut seen = seen.borrow_mut();
            seen.extend(values.map(|values| values.as_slice().to_vec()));
        }
        Ok(Control::Continue)
    };
    // It ends by its steps, or where it fails; what was seen until then counts.
    let _ = integrator.flow(
        &field,
        (0.0, FOREVER),
        &units.inward(&start),
        Some(&mut observer),
    );
    let seen = seen.into_inner();
    let moves = (0..start.len()).filter_map(|state| {
        let values: Vec<f64> = seen.iter().map(|values| values[state]).collect();
        let low = values.iter().copied().fold(f64::INFINITY, f64::min);
        let high = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let extent = (high - low) / units.sizes[state];
        let unit = 10f64.powf((ROUGH * (high - low)).log10().floor());
        let middle = (0.5 * (low + high) / unit).round() * unit;
        // Without the last digits, and without the sign of a zero.
        let middle = format!("{middle:.11e}").parse().unwrap_or(middle) + 0.0;
        let falls = values
            .windows(2)
            .filter(|pair| pair[0] > middle && pair[1] <= middle);
        let falls = falls.count();
        (extent.is_finite() && extent > STILL && falls > 1)
            .then_some((state, middle, falls, extent))
    });
    let most = moves.reduce(|best, other| {
        let (_, _, falls, extent) = other;
        match falls > best.2 || (falls == best.2 && extent > best.3) {
            true => other,
            false => best,
        }
    });
    most.map(|(state, middle, ..)| format!("{}={middle}", model.system.states()[state]))
}
