//! The plan of a sweep in words.

use super::super::system::Described;
use super::super::units::Quantity;
use super::{Moving, SweepPlan, Swept};
use twinslip::error::count;
use twinslip::sweep::Grid;

impl SweepPlan {
    /// The plan, one subject a line.
    pub fn explain(&self) -> String {
        let settings = &self.settings;
        let starts = match settings.starts {
            1 => "one start each".to_owned(),
            starts => format!("{starts} starts each"),
        };
        let along = || match &self.axes.names[..] {
            [] => "one point".to_owned(),
            [only] => format!("a line of {only}"),
            names => format!("the plane of {}", names.join(" and ")),
        };
        let grid = match &settings.grid {
            Grid::Basin { .. } => "starts (psi1, psi2) at one V_H and K".to_owned(),
            Grid::Plane { .. } => format!("the plane of V_H and K, {starts}"),
            Grid::Systems { .. } => match &self.basin {
                Some(states) => format!("starts ({}) of one system", states.names.join(", ")),
                None => format!("{}, {starts}", along()),
            },
        };
        let part = match self.shard {
            None => "all".to_owned(),
            Some(shard) => format!("part {shard}, {} rows", count(self.rows())),
        };
        let follow = match (settings.follow, &settings.grid) {
            (true, Grid::Plane { .. }) => {
                "on: each point starts on the attractor of its neighbour; a line of V_H at one K is computed as a whole"
            }
            (true, _) => {
                "on: each point starts on the attractor of its neighbour; a line of the first parameter is computed as a whole"
            }
            (false, _) => "off: `follow` is not given; points are independent",
        };
        let lyapunov = match settings.lyapunov {
            true => "of every point",
            false => "only where the regime needs them: `lyapunov` is not given",
        };
        let dimension = match &self.layout.moves {
            Moving::Interfaces(interfaces) => interfaces + 1,
            Moving::States(states, _) => states.len(),
        };
        let method = match settings.grid {
            Grid::Plane { .. } | Grid::Basin { .. } => {
                "taylor, several points at once in vector lanes"
            }
            Grid::Systems { .. } => "taylor, one point at a time",
        };
        let curves = match (&settings.grid, self.drawn && self.curves.is_empty()) {
            (Grid::Systems { .. }, true) => {
                "\n  curves            none: bifurcations are drawn only over V_H and K of equal interfaces, or of one"
            }
            _ => "",
        };
        let section = self.section();
        let section = section.map_or(String::new(), |text| {
            format!("\n  section           {text}")
        });
        format!(
            "plan of this command
  grid              {grid}: {} rows
  part              {part}
  dimension         {dimension}
  method            {method}
  rtol              {:e}{section}
  following         {follow}
  exponents         {lyapunov}
  bound on work     {} returns, {} steps per point
  rows              written in the order of the grid as soon as all before them are done{curves}",
            count(settings.points()),
            settings.rtol,
            count(settings.max_returns),
            count(settings.max_steps)
        )
    }

    /// Where the returns are, of all but V_H and K.
    fn section(&self) -> Option<String> {
        let Grid::Systems { .. } = self.settings.grid else {
            return None;
        };
        Some(match &self.layout.moves {
            Moving::Interfaces(_) => "tau_ss at the mean slip rate, falling".into(),
            Moving::States(states, section) => {
                let name = states[*section];
                match self
                    .surface
                    .as_deref()
                    .and_then(|text| text.split_once('='))
                {
                    Some((_, value)) => format!(
                        "{name} falling through {value}; the time scale is measured along a transient counted in steps"
                    ),
                    None => format!(
                        "{name} falling through the middle of its range after a transient of 512 steps, in windows of 512 steps that double until one has six turning points"
                    ),
                }
            }
        })
    }

    /// The labels of the axes of a map, with units.
    pub fn axis_labels(&self) -> [String; 2] {
        [0, 1].map(|i| {
            let name = self.axes.names.get(i).map_or("", String::as_str);
            let unit = match name {
                "driving" => self.unit(Quantity::SlipRate),
                "stiffness" => self.unit(Quantity::Stiffness),
                _ => self.unit_of(name),
            };
            let name = match name {
                "driving" => "V_H",
                "stiffness" => "K",
                name => name,
            };
            match unit {
                Some(unit) => format!("{name} [{unit}]"),
                None => name.to_owned(),
            }
        })
    }

    fn unit(&self, quantity: Quantity) -> Option<&'static str> {
        let name = self.system.units().name(quantity);
        (!name.is_empty() && name != "1").then_some(name)
    }

    /// The unit of a parameter of interfaces other than V_H and K, as it is given.
    fn unit_of(&self, name: &str) -> Option<&'static str> {
        let Swept::Interfaces(system) = &self.system else {
            return None;
        };
        let si = system.units.si();
        match name.trim_end_matches("_1").trim_end_matches("_2") {
            "healing_time" if si => Some("s"),
            "healing_time" => Some("L/V*"),
            "damping" if si => Some("Pa s/m"),
            "damping" => Some("a sigma/V*"),
            "slip_length" if si => Some("m"),
            "slip_length" => Some("L_1"),
            "normal_stress" if si => Some("Pa"),
            "normal_stress" => Some("sigma_1"),
            _ => None,
        }
    }
}
