//! The picture of an estimate with its bands: areas along curves, bars at points, and paler cells of a map.

use super::bands::Ends;
use super::sweep::Tally;
use std::collections::HashMap;
use twinslip_output::plot::{Area, Bars, Cells, Drawing, Mark, PlotSeries, Shade, Swatch};
use twinslip_tasks::views::REGIMES;
use twinslip_tasks::views::sweep::tints::RegimeKind;

/// What areas and bars are.
const NAME: &str = "95 % of the fit";
/// Points that agree to this, relatively, are one: rows and special points are located on their own.
const SAME: f64 = 1e-6;
/// The colour of a curve that has none of its own.
const USUAL: usize = 0;
/// Steps of probability that a map tells apart.
const STEPS: f64 = 8.0;
/// How much of white there is in the colour of a regime that is as likely as not.
const PALEST: f64 = 0.75;

/// The bands of rows, by the places at which a picture shows these.
#[derive(Debug, Default)]
pub struct BandsAt(HashMap<[u64; 2], Ends>);

impl BandsAt {
    /// That a point has a band across.
    pub fn put(&mut self, x: f64, y: f64, ends: Ends) {
        self.0.insert([x, y].map(f64::to_bits), ends);
    }

    fn get(&self, x: f64, y: f64) -> Option<Ends> {
        self.0.get(&[x, y].map(f64::to_bits)).copied()
    }

    /// The band of a curve; `None` where no point of it has one.
    fn area(&self, number: usize, series: &PlotSeries) -> Option<Area> {
        let points = series.x.iter().zip(&series.y);
        let ends = points.map(|(&x, &y)| self.get(x, y).unwrap_or([f64::NAN; 2]));
        let (lower, upper): (Vec<f64>, Vec<f64>) = ends.map(|[low, high]| (low, high)).unzip();
        let some = lower.iter().any(|x| x.is_finite());
        some.then(|| Area {
            label: NAME.into(),
            x: series.x.clone(),
            lower,
            upper,
            colour: series.colour.unwrap_or(USUAL + number),
            left_out: series.left_out.clone(),
        })
    }
}

/// A point with its bands.
#[derive(Debug, Clone, PartialEq)]
pub struct PointAt {
    /// Its abscissa.
    pub x: f64,
    /// Its ordinate, where a picture shows just that.
    pub y: Option<f64>,
    /// The band of the abscissa.
    pub along: Option<Ends>,
    /// The band of the ordinate.
    pub across: Option<Ends>,
}

impl PointAt {
    fn is(&self, mark: &Mark) -> bool {
        let same = |a: f64, b: f64| (a - b).abs() <= SAME * a.abs().max(b.abs());
        same(self.x, mark.x) && self.y.is_none_or(|y| same(y, mark.y))
    }
}

/// Draws what is known: of curves and of points.
pub fn with_bands(drawing: &mut Drawing, bands: &BandsAt, points: &[PointAt]) {
    for panel in drawing.panels_mut() {
        let curves = panel.series.iter().enumerate();
        panel.areas = curves
            .filter_map(|(i, series)| bands.area(i, series))
            .collect();
        for mark in &mut panel.marks {
            if let Some(point) = points.iter().find(|point| point.is(mark)) {
                let pair = |ends: Option<Ends>| {
                    // A band of no breadth, as of a value on which a curve lands, would be a dot.
                    let ends = ends.filter(|[low, high]| high - low > SAME * high.abs());
                    ends.map(|[low, high]| (low, high))
                };
                mark.bars = Bars {
                    x: pair(point.along),
                    y: pair(point.across),
                };
            }
        }
    }
}

/// Shows at each point of a map the likeliest regime, the paler the less probable it is.
pub fn with_probabilities(drawing: &mut Drawing, tally: &Tally, own: &[Option<usize>]) {
    for panel in drawing.panels_mut() {
        let title = panel
            .cells
            .as_mut()
            .is_some_and(|map| paler(map, tally, own));
        if title && panel.title.starts_with("regimes") {
            panel.title = format!("likeliest {}", panel.title);
        }
    }
}

/// Whether the cells are those of the rows.
fn paler(map: &mut Cells, tally: &Tally, own: &[Option<usize>]) -> bool {
    if map.fills.len() != own.len() || tally.draws == 0 {
        return false;
    }
    let mut others: Vec<RegimeKind> = Vec::new();
    for (row, fill) in map.fills.iter_mut().enumerate() {
        let Some((likeliest, probability)) = tally.likeliest(row) else {
            continue;
        };
        if own[row] != Some(likeliest) {
            let kind = RegimeKind::of_regime(REGIMES[likeliest]);
            *fill = vec![kind.shade()];
            if !others.contains(&kind) {
                others.push(kind);
            }
        }
        for shade in fill {
            *shade = pale(*shade, probability);
        }
    }
    let known =
        |shade: Shade, map: &Cells| map.swatches.iter().any(|one| one.shades.contains(&shade));
    for kind in others {
        let shade = kind.shade();
        if !known(shade, map) {
            map.swatches.push(Swatch {
                shades: vec![shade],
                label: kind.words(false).into(),
            });
        }
    }
    // Greys: of any regime.
    let steps = [1.0, 0.75, 0.5].map(|probability| pale(Shade::new([110; 3]), probability));
    map.swatches.push(Swatch {
        shades: steps.into(),
        label: "in 100, 75 and 50 % of the fit, or less".into(),
    });
    true
}

fn pale(shade: Shade, probability: f64) -> Shade {
    let sure = (STEPS * (2.0 * probability - 1.0))
        .round()
        .clamp(0.0, STEPS)
        / STEPS;
    let white = PALEST * (1.0 - sure);
    shade.lighter(shade.lightness + (1.0 - shade.lightness) * white)
}
