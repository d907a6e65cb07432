//! The colours of a field on a mesh, from the request and from the values.

use fairing_mesh::TriMesh;

use crate::color::ColorMap;
use crate::error::FigureError;
use crate::field::Field;
use crate::scale::{Center, Limits, Scale, ScaleOptions, Spread};

/// Requested colours; the rest follows from the values.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(default, deny_unknown_fields))]
pub struct ColoringOptions {
    /// The colours. `None`: [`ColorMap::CoolWarm`] for values of both signs, else
    /// [`ColorMap::Viridis`].
    pub map: Option<ColorMap>,
    /// The values at the two ends, in units of the field. `None`: the 2nd and the 98th percentile
    /// of the defined values, for [`ColorMap::CoolWarm`] widened to be centred on zero.
    pub range: Option<(f64, f64)>,
    /// True if every colour covers the same number of values.
    pub equalize: bool,
}

impl ColoringOptions {
    /// The scale options for a field with these values.
    pub(crate) fn scale_options(&self, values: &[f64]) -> ScaleOptions {
        let signed = values.iter().any(|&x| x < 0.0) && values.iter().any(|&x| x > 0.0);
        let mut options = if signed { ScaleOptions::SIGNED } else { ScaleOptions::MAGNITUDE };
        if let Some(map) = self.map {
            options.map = map;
            options.center = if map == ColorMap::CoolWarm { Center::Zero } else { Center::Free };
        }
        if let Some((low, high)) = self.range {
            options.limits = Limits::Fixed { low, high };
            options.center = Center::Free;
        }
        if self.equalize {
            options.spread = Spread::Equalized;
            options.center = Center::Free;
        }
        options
    }

    /// The scale of a field on the vertices of `mesh`, and the colour of each vertex.
    ///
    /// Boundary vertices do not count for the range, unless there are no others: one-sided
    /// estimates there are often far from those inside. Undefined vertices, and isolated ones,
    /// which are never drawn, are ignored and get the colour [`UNDEFINED`](crate::UNDEFINED).
    ///
    /// With `None` every value counts. An undefined curvature is stored as zero, the value of a
    /// plane, so pass the flags of a curvature: `Some(&curvature.undefined())`.
    ///
    /// # Errors
    ///
    /// [`FigureError::Count`] unless there are as many values as vertices, [`FigureError::Count`]
    /// unless there are as many flags, and the errors of [`Scale::new`], such as
    /// [`FigureError::NoValues`] if all values are undefined.
    pub fn colors(
        &self,
        mesh: &TriMesh,
        values: &[f64],
        undefined: Option<&[bool]>,
    ) -> Result<(Scale, Vec<[u8; 3]>), FigureError> {
        let (expected, found) = (mesh.vertex_count(), values.len());
        if found != expected {
            return Err(FigureError::Count { what: "values", expected, found });
        }
        let mut field = Field::new(values);
        if let Some(undefined) = undefined {
            field = field.undefined_where(undefined)?;
        }
        let topology = mesh.topology();
        let mut isolated = vec![false; expected];
        topology.isolated_vertices().for_each(|v| isolated[v as usize] = true);
        for without in [
            field.clone().undefined_where(&isolated)?,
            field
                .clone()
                .undefined_where(&isolated)?
                .range_without(topology.boundary_vertices())?,
        ] {
            if without.counted().next().is_some() {
                field = without;
            }
        }
        let defined: Vec<f64> = field.values().flatten().collect();
        let scale = Scale::new(&[&field], &self.scale_options(&defined))?;
        let colors = scale.colors(&field);
        Ok((scale, colors))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scale::UNDEFINED;

    fn options(asked: ColoringOptions, values: &[f64]) -> (ColorMap, Limits, Center, Spread) {
        let found = asked.scale_options(values);
        (found.map, found.limits, found.center, found.spread)
    }

    #[test]
    fn signs_decide_the_map_unless_it_is_given() {
        let percentiles = Limits::Percentiles { low: 2.0, high: 98.0 };
        let free = ColoringOptions::default();
        let signed = (ColorMap::CoolWarm, percentiles, Center::Zero, Spread::Linear);
        assert_eq!(options(free, &[-1.0, 2.0]), signed);
        let magnitude = (ColorMap::Viridis, percentiles, Center::Free, Spread::Linear);
        assert_eq!(options(free, &[0.0, 2.0]), magnitude);
        assert_eq!(options(free, &[0.0, -2.0]), magnitude);
        let magma = ColoringOptions { map: Some(ColorMap::Magma), ..free };
        let expected = (ColorMap::Magma, percentiles, Center::Free, Spread::Linear);
        assert_eq!(options(magma, &[-1.0, 2.0]), expected);
        let cool_warm = ColoringOptions { map: Some(ColorMap::CoolWarm), ..free };
        assert_eq!(options(cool_warm, &[1.0, 2.0]), signed);
    }

    /// A given range is kept, and equal shares have no middle.
    #[test]
    fn a_range_and_equal_shares_are_not_centred() {
        let free = ColoringOptions::default();
        let given = ColoringOptions { range: Some((-1.0, 5.0)), ..free };
        let limits = Limits::Fixed { low: -1.0, high: 5.0 };
        let expected = (ColorMap::CoolWarm, limits, Center::Free, Spread::Linear);
        assert_eq!(options(given, &[-1.0, 2.0]), expected);
        let equal = options(ColoringOptions { equalize: true, ..free }, &[-1.0, 2.0]);
        assert_eq!((equal.2, equal.3), (Center::Free, Spread::Equalized));
    }

    /// A fan around vertex 0: the only one inside determines the range; without it the boundary
    /// does.
    #[test]
    fn the_boundary_counts_where_there_is_nothing_else() {
        let corners = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [-1.0, -1.0, 0.0]];
        let fan = TriMesh::new(corners.clone(), vec![[0, 1, 2], [0, 2, 3], [0, 3, 1]]).unwrap();
        let asked = ColoringOptions::default();
        let (scale, _) = asked.colors(&fan, &[3.0, 10.0, 20.0, 30.0], None).unwrap();
        assert_eq!((scale.low(), scale.high()), (3.0, 3.0));
        let open = TriMesh::new(corners[..3].to_vec(), vec![[0, 1, 2]]).unwrap();
        let flags = [false, false, true];
        let (scale, colors) = asked.colors(&open, &[1.0, 2.0, 9.0], Some(&flags)).unwrap();
        assert!(scale.low() >= 1.0 && scale.high() <= 2.0);
        assert_eq!((colors[2], colors.contains(&scale.color(1.0))), (UNDEFINED, true));
        let short = asked.colors(&open, &[1.0], None).unwrap_err();
        assert_eq!(short, FigureError::Count { what: "values", expected: 3, found: 1 });
    }

    /// Two triangles at an edge, all of it boundary, and a vertex of no face: what is undefined or
    /// not drawn decides neither range nor map.
    #[test]
    fn nothing_is_taken_from_what_has_no_value_or_is_not_drawn() {
        let corners = vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 0.0], [9.0; 3]];
        let mesh = TriMesh::new(corners, vec![[0, 1, 2], [1, 3, 2]]).unwrap();
        let asked = ColoringOptions::default();
        let flags = [false, false, true, false, false];
        let values = [2.0, 3.0, -7.0, 4.0, 50.0];
        let (scale, colors) = asked.colors(&mesh, &values, Some(&flags)).unwrap();
        assert!(scale.low() >= 2.0 && scale.high() <= 4.0, "{scale:?}");
        assert_eq!((scale.map(), colors[2]), (ColorMap::Viridis, UNDEFINED));
        let (scale, _) = asked.colors(&mesh, &[2.0, 3.0, 3.0, 4.0, -50.0], None).unwrap();
        assert!(scale.low() >= 2.0 && scale.high() <= 4.0, "{scale:?}");
        let all = asked.colors(&mesh, &[0.0; 5], Some(&[true; 5])).unwrap_err();
        assert_eq!(all, FigureError::NoValues);
        let points = TriMesh::new(vec![[0.0; 3], [1.0; 3]], vec![]).unwrap();
        let (scale, _) = asked.colors(&points, &[1.0, 2.0], None).unwrap();
        assert!(scale.high() > scale.low());
    }
}
