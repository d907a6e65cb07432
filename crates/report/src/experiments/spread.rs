//! Spread of the values of a field over a mesh.

use fairing_operators::curvature::ScalarCurvature;
use fairing_sparse::median;

use crate::model::table::{Cell, Table, Unit};

/// A table of [`push`]ed rows.
pub(super) fn table(id: &str, caption: &str) -> Table {
    Table::new(
        id,
        caption,
        &[
            ("mesh", Unit::Label),
            ("field", Unit::Label),
            ("unit", Unit::Label),
            ("vertices", Unit::Label),
            ("defined", Unit::Count),
            ("least", Unit::One),
            ("median", Unit::One),
            ("greatest", Unit::One),
            ("mean size", Unit::One),
        ],
    )
    .aside(&["defined", "mean size"])
}

/// Adds a row for the vertices inside and, if there are any, one for those on
/// the boundary.
pub(super) fn push(table: &mut Table, mesh: &str, name: &str, unit: &str, field: &ScalarCurvature) {
    for (place, on_boundary) in [("inside", false), ("boundary", true)] {
        let mut values: Vec<f64> = (0..field.values.len())
            .filter(|&v| field.boundary[v] == on_boundary && field.status[v].is_defined())
            .map(|v| field.values[v])
            .collect();
        if values.is_empty() {
            continue;
        }
        values.sort_unstable_by(f64::total_cmp);
        let size = values.iter().map(|x| x.abs()).sum::<f64>() / values.len() as f64;
        // Rounding is shown as what it is, but not compared digit by digit.
        let clean = |x: f64| if x.abs() < 1e-9 { Cell::from(0.0) } else { Cell::from(x) };
        let [first, last] = [0, values.len() - 1].map(|i| clean(values[i]));
        let middle = median(&values).map_or(Cell::Missing, clean);
        table.push([
            mesh.into(),
            name.into(),
            unit.into(),
            place.into(),
            values.len().into(),
            first,
            middle,
            last,
            clean(size),
        ]);
    }
}
