//! Curves of Hopf points in the (V_H, K) plane: K of the closed form (16), (29) or (34) along a curve of equilibria.
//!
//! Along the equilibria K is a smooth function, through zero and below too, where nothing oscillates; what counts is where it is
//! positive, omega^2 is, and K lies within its range. Each such stretch is a curve of the locus.
//!
//! Looked for on the way: the largest K; zeros of l_1; omega = 0 (Bogdanov-Takens) and a third eigenvalue zero (zero-Hopf).
//! On the symmetric curve there is neither of the last two, as the third eigenvalue is k_c / F_V = 2 K / F_V > 0 (27) and
//! omega^2 = 2 K G_psi / F_V > 0. On the asymmetric one omega^2 = c_1 = c_0 / c_2 of (30) vanishes only with c_0, at a fold. With
//! the paper's parameters all curves end at K = 0: at 2 V_M and 2 V_m the symmetric one, at 2 V_M and where V_fast = V_m
//! the asymmetric one, but for one of no consequence that leaves the Bogdanov-Takens point of V_sn at K = 4.4e-13. l_1 has
//! no zero there either (tests/curves_equilibria.rs; a search over 1293 other sets of parameters of (35) found none either).

use super::crossing::QuadraticRoot;
use super::curves::{AlongDriving, CurveVariables};
use super::hopf::HopfPoints;
use super::pieces::{Ends, PieceEnd};
use super::special::Teller;
use super::trace::Trace;
use crate::bifurcation::LocusRequest;
use crate::continuation::{Settings, Stop, follow};
use crate::equilibrium::Symmetry;
use crate::error::{Error, Result};
use std::ops::ControlFlow;

/// The longest step in ln V_H.
const LONGEST: f64 = 0.1;

pub(super) fn locus(request: &LocusRequest, teller: &mut Teller<'_>) -> Result<ControlFlow<()>> {
    let settings = settings(request)?;
    let (from, to) = request.driving;
    let interfaces = request.slab.interfaces;
    let law = &request.slab.law;
    let wants = |s: Symmetry| request.symmetry.is_none_or(|wanted| wanted == s);
    let mut curves = 0;
    // one curve of equilibria from its begin to its end; nothing where the observer has seen enough
    let mut piece = |curve: CurveVariables, root: QuadraticRoot, begin: &PieceEnd| {
        let mut trace = Trace {
            request,
            points: HopfPoints { law, curve, root },
            begin,
            teller: &mut *teller,
            curves: &mut curves,
            inside: false,
        };
        let branch = follow(
            &AlongDriving { law, curve },
            &begin.start,
            &settings,
            &mut trace,
        )?;
        let observer = branch.stopped == Stop::Observer;
        if matches!(branch.stopped, Stop::MaxPoints(_)) {
            let limit = request.max_points;
            return Err(Error::TooManyPoints { limit });
        }
        let gave_up = matches!(branch.stopped, Stop::StepTooSmall { .. });
        let ended = observer || gave_up && trace.gave_up(&branch).is_break();
        Ok::<_, Error>((!ended).then_some(branch))
    };
    if wants(Symmetry::Symmetric) {
        let curve = CurveVariables::Symmetric { interfaces };
        let rates = [from / interfaces as f64; 2];
        let begin = PieceEnd::at_range_end(law, curve, from, from < to, rates);
        if piece(curve, QuadraticRoot::Larger, &begin)?.is_none() {
            return Ok(ControlFlow::Break(()));
        }
    }
    if interfaces == 2 && wants(Symmetry::Asymmetric) {
        for root in [QuadraticRoot::Larger, QuadraticRoot::Smaller] {
            let mut ends = Ends::of(law, (from, to))?;
            while let Some(begin) = ends.next() {
                match piece(CurveVariables::Asymmetric, root, &begin)? {
                    Some(branch) => ends.reached(&branch),
                    None => return Ok(ControlFlow::Break(())),
                }
            }
        }
    }
    Ok(ControlFlow::Continue(()))
}

fn settings(request: &LocusRequest) -> Result<Settings> {
    let (a, b) = request.driving;
    let inside = |x: &&f64| **x >= a.min(b) && **x <= a.max(b);
    let wanted = request.at_driving.iter().filter(inside);
    Settings {
        wanted: wanted.map(|x| x.ln()).collect(),
        max_points: request.max_points,
        ..Settings::new((a.min(b).ln(), a.max(b).ln()), LONGEST * request.step)?
    }
    .checked()
}
