//! Records of a slider whose load point moves in steps, by Runge and Kutta's method.

use super::synthetic::Chance;

/// A slider and its measurement.
pub struct Slid {
    /// Friction per metre.
    pub stiffness: f64,
    pub direct_effect: f64,
    pub evolution_effect: f64,
    pub slip_length: f64,
    /// The standard deviation of the noise.
    pub noise: f64,
    /// That of the displacement, in m.
    pub scatter: f64,
    /// When the load point changes to which velocity; the first is V*.
    pub program: Vec<(f64, f64)>,
    pub until: f64,
}

impl Slid {
    /// dmu/dt and d ln(psi)/dt of the ageing law.
    fn rates(&self, [mu, log]: [f64; 2], driving: f64) -> [f64; 2] {
        let reference = self.program[0].1;
        let v = ((mu - 0.6 - self.evolution_effect * log) / self.direct_effect).exp();
        [
            self.stiffness * (driving - reference * v),
            reference / self.slip_length * ((-log).exp() - v),
        ]
    }

    /// As a file, with so many rows: s, µm, friction.
    pub fn record(&self, rows: usize, seed: u64) -> String {
        /// Steps are so short, in s.
        const STEP: f64 = 4e-3;
        let mut chance = Chance::new(seed);
        let mut text = "time_s,displacement_um,friction\n".to_owned();
        let (mut now, mut moved, mut y, mut at) = (0.0, 0.0, [0.6, 0.0], 0);
        for row in 0..rows {
            let t = self.until * row as f64 / (rows - 1) as f64;
            while now < t {
                let next = self.program.get(at + 1).map_or(t, |change| change.0);
                let (end, driving) = (t.min(next), self.program[at].1);
                let count = ((end - now) / STEP).ceil();
                let h = (end - now) / count;
                for _ in 0..count as usize {
                    let after = |by: f64, k: [f64; 2]| [y[0] + by * k[0], y[1] + by * k[1]];
                    let one = self.rates(y, driving);
                    let two = self.rates(after(h / 2.0, one), driving);
                    let three = self.rates(after(h / 2.0, two), driving);
                    let four = self.rates(after(h, three), driving);
                    let mean = |i: usize| (one[i] + 2.0 * (two[i] + three[i]) + four[i]) / 6.0;
                    y = after(h, [mean(0), mean(1)]);
                }
                moved += driving * (end - now);
                now = end;
                at += usize::from(self.program.get(at + 1).is_some_and(|next| now >= next.0));
            }
            let mu = y[0] + self.noise * chance.normal();
            let scatter = match self.scatter {
                0.0 => 0.0,
                scatter => scatter * chance.normal(),
            };
            text += &format!("{t:.6},{:.6},{mu:.7}\n", (moved + scatter) * 1e6);
        }
        text
    }
}
