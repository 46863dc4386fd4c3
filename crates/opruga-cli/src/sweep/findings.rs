//! The findings of a sweep, as text and as data.

use opruga::draw::format_value;
use opruga::io::problem::visible;
use opruga::math::words::counted;
use opruga::sweep::{Design, Row, Status, Sweep};
use serde_json::json;

/// The findings of a table.
pub(super) struct Found<'a> {
    pub(super) sweep: &'a Sweep,
    pub(super) rows: &'a [Row],
    pub(super) length_unit: &'a str,
}

/// The lowest and the highest value of a metric, with their rows.
struct Ends<'a> {
    lowest: (f64, &'a Row),
    highest: (f64, &'a Row),
}

impl Found<'_> {
    /// The extremes of a metric over some rows, or `None` if no row has a value.
    fn ends<'r>(&self, metric: usize, rows: impl Iterator<Item = &'r Row>) -> Option<Ends<'r>> {
        rows.filter_map(|row| Some((row.numbers[metric]?, row))).fold(None, |ends, found| match ends {
            None => Some(Ends { lowest: found, highest: found }),
            Some(ends) => Some(Ends {
                lowest: if found.0 < ends.lowest.0 { found } else { ends.lowest },
                highest: if found.0 > ends.highest.0 { found } else { ends.highest },
            }),
        })
    }

    /// The rows in which a parameter varies. If parameters vary one at a time, each parameter has
    /// rows of its own.
    fn rows_of(&self, axis: usize) -> impl Iterator<Item = &Row> {
        self.rows.iter().filter(move |row| row.values[axis].is_some())
    }

    fn failed(&self) -> Vec<(&str, usize)> {
        let mut counts: Vec<(&str, usize)> = Vec::new();
        for row in self.rows.iter().filter(|row| row.status != Status::Done) {
            match counts.iter_mut().find(|(code, _)| *code == row.status.word()) {
                Some((_, count)) => *count += 1,
                None => counts.push((row.status.word(), 1)),
            }
        }
        counts
    }

    pub(super) fn to_json(&self) -> serde_json::Value {
        let end = |(value, row): (f64, &Row)| {
            let at = self.sweep.axes.iter().zip(&row.values);
            let at: serde_json::Map<_, _> =
                at.filter_map(|(axis, value)| Some((axis.path.clone(), value.clone()?.into()))).collect();
            json!({"value": value, "point": row.number, "at": at})
        };
        let ends = |ends: Ends<'_>| json!({"lowest": end(ends.lowest), "highest": end(ends.highest)});
        let metrics = self.sweep.metrics.iter().enumerate().map(|(index, metric)| {
            let mut object = self.ends(index, self.rows.iter()).map_or_else(|| json!({}), ends);
            object["name"] = metric.name.clone().into();
            object["unit"] = metric.unit(self.length_unit).into();
            object["numbers"] = self.rows.iter().filter(|row| row.numbers[index].is_some()).count().into();
            if self.sweep.design == Design::Each {
                let of = (0..self.sweep.axes.len()).map(|axis| {
                    let mut object = self.ends(index, self.rows_of(axis)).map_or_else(|| json!({}), ends);
                    object["parameter"] = self.sweep.axes[axis].path.clone().into();
                    object
                });
                object["parameters"] = of.collect::<Vec<_>>().into();
            }
            object
        });
        let failed = self.failed();
        json!({
            "schema": 1,
            "scene": self.sweep.name,
            "parameters": self.sweep.axes.iter().map(|axis| &axis.path).collect::<Vec<_>>(),
            "points": self.rows.len(),
            "done": self.rows.iter().filter(|row| row.status == Status::Done).count(),
            "failed": failed.iter().map(|(code, count)| json!({"code": code, "count": count})).collect::<Vec<_>>(),
            "metrics": metrics.collect::<Vec<_>>(),
        })
    }

    /// Writes a line for a metric over some rows.
    pub(super) fn write_line(
        &self,
        f: &mut core::fmt::Formatter<'_>,
        name: &str,
        metric: usize,
        axis: Option<usize>,
    ) -> core::fmt::Result {
        let unit = self.sweep.metrics[metric].unit(self.length_unit);
        let ends = match axis {
            Some(axis) => self.ends(metric, self.rows_of(axis)),
            None => self.ends(metric, self.rows.iter()),
        };
        let Some(Ends { lowest, highest }) = ends else { return writeln!(f, "  {name:<30} no numbers") };
        let at = |row: &Row| {
            let named = self.sweep.axes.iter().zip(&row.values);
            let values: Vec<String> = named
                .filter_map(|(axis, value)| {
                    let value = value.as_deref()?;
                    let value = opruga::sweep::number(value).map_or_else(|| visible(value), format_value);
                    let word = axis.path.rsplit('.').next().unwrap_or_default();
                    Some(format!("{} = {value}", visible(word)))
                })
                .collect();
            values.join(", ")
        };
        let (low, high) = (format_value(lowest.0), format_value(highest.0));
        writeln!(f, "  {name:<30} {low:>8} to {high:>8} {unit:<4} (at {}; at {})", at(lowest.1), at(highest.1))
    }
}

impl core::fmt::Display for Found<'_> {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        let done = self.rows.iter().filter(|row| row.status == Status::Done).count();
        writeln!(f, "{}: {} of {} done", self.sweep.name, done, counted(self.rows.len() as u64, "point", "points"))?;
        for (code, count) in self.failed() {
            writeln!(f, "  {count} × {code}")?;
        }
        if self.sweep.design == Design::Each {
            for (axis, about) in self.sweep.axes.iter().enumerate() {
                writeln!(f, "{}", visible(&about.path))?;
                for (index, metric) in self.sweep.metrics.iter().enumerate() {
                    self.write_line(f, &metric.name, index, Some(axis))?;
                }
            }
            return Ok(());
        }
        for (index, metric) in self.sweep.metrics.iter().enumerate() {
            self.write_line(f, &metric.name, index, None)?;
        }
        Ok(())
    }
}
