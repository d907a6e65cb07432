//! From the meshes of a GLB file to one mesh with fields.

use std::collections::{BTreeSet, HashMap};

use glam::{DAffine3, DMat3, DVec3};

use crate::io::NumberType;
use crate::io::columns::{NamedArray, from_arrays};
use crate::io::error::{Fault, unexpected};
use crate::io::glb::accessor::{Accessors, to_srgb};
use crate::io::glb::buffers::Beside;
use crate::io::glb::document::{Document, Instance, POINTS, TRIANGLES, instances};
use crate::io::glb::entry::Entry;
use crate::io::parsed::{Broken, NO_VERTEX, Parsed, check_finite, strip_triangles, vertex_index};

/// The most attributes that a note names.
const MAX_NAMED: usize = 10;

pub(crate) fn parse(bytes: &[u8], broken: Broken, beside: Beside<'_>) -> Result<Parsed, Fault> {
    let document = Document::read(bytes, beside)?;
    let root = document.root();
    check_extensions(&root)?;
    let mut parsed = Parsed::default();
    note_ignored(&root, &mut parsed.notes)?;
    let instances = instances(&root, &mut parsed.notes)?;
    let mut accessors = Accessors::new(&document, bytes.len() + document.length());
    let mut joined = Joined { parsed, broken, ..Joined::default() };
    for instance in &instances {
        joined.add(&mut accessors, &root, instance)?;
    }
    if instances.len() > 1 {
        joined.parsed.notes.push(format!("{} meshes are one mesh", instances.len()));
    }
    Ok(joined.finish())
}

/// Extensions without which the positions and faces can be read.
const HARMLESS: [&str; 8] = [
    "KHR_mesh_quantization",
    "KHR_lights_punctual",
    "KHR_materials_",
    "KHR_texture_",
    "EXT_texture_",
    "MSFT_texture_",
    "KHR_xmp",
    "KHR_animation_pointer",
];

/// Refuses files that cannot be read without an extension, compressed ones for instance.
fn check_extensions(root: &Entry<'_>) -> Result<(), Fault> {
    for extension in root.list("extensionsRequired")? {
        let name = extension.text().unwrap_or_default();
        if !HARMLESS.iter().any(|harmless| name.starts_with(harmless)) {
            let expected = "a file that is readable without extensions";
            let advice = match name {
                "KHR_draco_mesh_compression" => ": Blender or gltf-transform can save it without",
                "EXT_meshopt_compression" | "KHR_meshopt_compression" => {
                    ": gltf-transform can save it without"
                }
                _ => "",
            };
            let found = format!("{name}, which it requires{advice}");
            return Err(Fault::whole(unexpected(expected, found)));
        }
    }
    Ok(())
}

/// Names the content that a mesh does not hold.
fn note_ignored(root: &Entry<'_>, notes: &mut Vec<String>) -> Result<(), Fault> {
    // One material, which every file has, says nothing.
    for (key, what, from) in
        [("materials", "materials", 2), ("images", "images", 1), ("animations", "animations", 1)]
    {
        let count = root.list(key)?.len();
        if count >= from {
            notes.push(format!("{count} {what} are ignored"));
        }
    }
    Ok(())
}

/// Bytes that a primitive counts for besides its arrays.
const PRIMITIVE: usize = 256;

/// Vertices that consecutive primitives share, and their place among those of the mesh.
struct Shared<'a> {
    attributes: Entry<'a>,
    first: u32,
    count: usize,
}

/// The vertices and faces of the instances so far.
#[derive(Default)]
struct Joined {
    broken: Broken,
    parsed: Parsed,
    arrays: Vec<NamedArray>,
    /// The number of an array by name and components.
    places: HashMap<(String, usize), usize>,
    colors: Vec<[u8; 3]>,
    lines: usize,
    alphas: usize,
    /// Attributes that a mesh does not hold, and morph targets.
    ignored: BTreeSet<String>,
}

impl Joined {
    fn add<'a>(
        &mut self,
        accessors: &mut Accessors<'a>,
        root: &Entry<'a>,
        instance: &Instance,
    ) -> Result<(), Fault> {
        let mesh = root.at("meshes", instance.mesh)?;
        let mut known: Option<Shared<'a>> = None;
        for primitive in mesh.list("primitives")? {
            accessors.spend(&primitive, 1, PRIMITIVE)?;
            if !primitive.list("targets")?.is_empty() {
                self.ignored.insert("morph targets".to_owned());
            }
            let attributes = primitive.required("attributes")?;
            let position = attributes.required("POSITION")?;
            let known_before = known.as_ref().filter(|shared| shared.attributes == attributes);
            let count = match known_before {
                Some(shared) => shared.count,
                None => accessors.open(position.count()?)?.count,
            };
            let faces = self.parsed.polygons.len();
            let triangles = triangles(accessors, &primitive, count, faces, self.broken)?;
            let Some(triangles) = triangles else {
                self.lines += 1;
                continue;
            };
            let first = match known_before {
                Some(shared) => shared.first,
                None => {
                    // Too many vertices are refused later.
                    let first = self.parsed.positions.len() as u32;
                    self.vertices(accessors, &attributes, &instance.to_scene)?;
                    known = Some(Shared { attributes, first, count });
                    first
                }
            };
            let mirrored = instance.to_scene.matrix3.determinant() < 0.0;
            for [a, b, c] in triangles {
                let [b, c] = if mirrored { [c, b] } else { [b, c] };
                let corner = |v: u32| if v == NO_VERTEX { v } else { v.saturating_add(first) };
                self.parsed.polygons.push_triangle([a, b, c].map(corner));
            }
        }
        Ok(())
    }

    /// Adds the vertices of a primitive with their attributes.
    fn vertices<'a>(
        &mut self,
        accessors: &mut Accessors<'a>,
        attributes: &Entry<'a>,
        to_scene: &DAffine3,
    ) -> Result<(), Fault> {
        let before = self.parsed.positions.len();
        let position = attributes.required("POSITION")?;
        let count = self.positions(accessors, &position, to_scene)?;
        for (name, entry) in attributes.members()? {
            let field = match name {
                "POSITION" => continue,
                "NORMAL" => "normal",
                "COLOR_0" => "",
                _ => match name.strip_prefix('_') {
                    Some(field) => field,
                    None => {
                        self.ignored.insert(name.to_owned());
                        continue;
                    }
                },
            };
            let accessor = accessors.open(entry.count()?)?;
            accessor.require_count(&entry, count)?;
            let mut values = accessor.floats();
            match name {
                "COLOR_0" => {
                    accessor.require(&entry, &[3, 4])?;
                    self.colors(&values, accessor.components);
                }
                "NORMAL" => {
                    accessor.require(&entry, &[3])?;
                    if *to_scene != DAffine3::IDENTITY {
                        turn(values.as_chunks_mut().0, to_scene.matrix3);
                    }
                    self.array(before, field, 3, values);
                }
                _ => self.array(before, field, accessor.components, values),
            }
        }
        Ok(())
    }

    /// Adds the positions, and returns their number.
    fn positions<'a>(
        &mut self,
        accessors: &mut Accessors<'a>,
        entry: &Entry<'a>,
        to_scene: &DAffine3,
    ) -> Result<usize, Fault> {
        let accessor = accessors.open(entry.count()?)?;
        accessor.require(entry, &[3])?;
        let positions = &mut self.parsed.positions;
        for (v, &position) in accessor.floats().as_chunks().0.iter().enumerate() {
            let position = if *to_scene == DAffine3::IDENTITY {
                position
            } else {
                to_scene.transform_point3(DVec3::from(position)).to_array()
            };
            check_finite(&position, positions.len(), self.broken)
                .map_err(|problem| accessor.fault(v, problem))?;
            positions.push(position);
        }
        Ok(accessor.count)
    }

    /// Adds colours, unless they are out of range.
    fn colors(&mut self, values: &[f64], components: usize) {
        let colors = values.chunks_exact(components);
        if !values.iter().all(|c| (0.0..=1.0).contains(c)) {
            let doubt = "vertex colours are not from 0 to 1: left out".to_owned();
            if !self.parsed.doubts.contains(&doubt) {
                self.parsed.doubts.push(doubt);
            }
            return;
        }
        self.alphas +=
            colors.clone().filter(|color| color.get(3).is_some_and(|&a| a != 1.0)).count();
        self.colors.extend(colors.map(|color| [color[0], color[1], color[2]].map(to_srgb)));
    }

    /// Adds values to those of the primitives before, which had `before` vertices.
    fn array(&mut self, before: usize, name: &str, components: usize, values: Vec<f64>) {
        let kind = Some(NumberType::F32);
        let place = *self.places.entry((name.to_owned(), components)).or_insert_with(|| {
            let name = name.to_owned();
            self.arrays.push(NamedArray { name, kind, components, values: vec![] });
            self.arrays.len() - 1
        });
        // If some vertices before have no value, the array stays incomplete.
        let array = &mut self.arrays[place];
        if array.values.len() == components * before {
            array.values.extend(values);
        }
    }

    fn finish(mut self) -> Parsed {
        let mut parsed = self.parsed;
        let count = parsed.positions.len();
        self.arrays.retain(|array| {
            let complete = array.values.len() == count * array.components;
            if !complete {
                let name = &array.name;
                parsed
                    .doubts
                    .push(format!("only some vertices have a value of {name:?}: left out"));
            }
            complete
        });
        let colored = self.colors.len();
        if 0 < colored && colored < count {
            let doubt = format!("only {colored} vertices have colours: left out");
            parsed.doubts.push(doubt);
        }
        let colors = (colored == count).then_some(self.colors);
        if self.lines > 0 {
            parsed.notes.push(format!("{} primitives of lines are ignored", self.lines));
        }
        if self.alphas > 0 {
            parsed.notes.push(format!("the alpha values of {} vertices are ignored", self.alphas));
        }
        if !self.ignored.is_empty() {
            let mut names: Vec<String> = self.ignored.into_iter().collect();
            if names.len() > MAX_NAMED {
                names.truncate(MAX_NAMED);
                names.push("…".to_owned());
            }
            parsed.notes.push(format!("data of vertices are ignored: {}", names.join(", ")));
        }
        if count > 0 {
            parsed.fields = from_arrays(self.arrays, colors, &mut parsed.notes).of_vertices();
        }
        parsed
    }
}

/// Turns normals with a surface, and makes them unit vectors again.
fn turn(normals: &mut [[f64; 3]], linear: DMat3) {
    // The matrix of cofactors is that of normals up to a factor, and exists where the surface is
    // pressed flat.
    let DMat3 { x_axis: a, y_axis: b, z_axis: c } = linear;
    let sign = linear.determinant().signum();
    let cofactors = DMat3::from_cols(b.cross(c), c.cross(a), a.cross(b)) * sign;
    for normal in normals {
        *normal = (cofactors * DVec3::from(*normal)).normalize_or_zero().to_array();
    }
}

const STRIP: usize = 5;
const FAN: usize = 6;

/// The triangles of a primitive with that many vertices, the first of them of number `first_face`;
/// none of points, and `None` for lines.
fn triangles(
    accessors: &mut Accessors<'_>,
    primitive: &Entry<'_>,
    vertices: usize,
    first_face: usize,
    broken: Broken,
) -> Result<Option<Vec<[u32; 3]>>, Fault> {
    let mode = primitive.optional_count("mode")?.unwrap_or(TRIANGLES);
    match mode {
        POINTS => return Ok(Some(vec![])),
        1..=3 => return Ok(None),
        TRIANGLES | STRIP | FAN => {}
        _ => return Err(primitive.fault("a mode from 0 to 6", mode.to_string())),
    }
    let indices = match primitive.get("indices") {
        Some(entry) => {
            let accessor = accessors.open(entry.count()?)?;
            let mut indices = accessor.indices(&entry)?;
            for (k, index) in indices.iter_mut().enumerate() {
                // A triangle has three indices, further ones of strips and fans one.
                let face = if mode == TRIANGLES { k / 3 } else { k.saturating_sub(2) };
                *index = vertex_index(i64::from(*index), first_face + face, vertices, broken)
                    .map_err(|problem| accessor.fault(k, problem))?;
            }
            indices
        }
        None => {
            accessors.spend(primitive, vertices, 4)?;
            // Positions of more vertices than that are more than a file has.
            (0..vertices as u32).collect()
        }
    };
    Ok(Some(match mode {
        STRIP => strip_triangles(&indices).collect(),
        FAN => match indices.split_first() {
            Some((&centre, rim)) => rim.windows(2).map(|pair| [centre, pair[0], pair[1]]).collect(),
            None => vec![],
        },
        _ => {
            let (triangles, rest) = indices.as_chunks();
            if !rest.is_empty() {
                let problem =
                    unexpected("three indices for each triangle", indices.len().to_string());
                return Err(Fault::whole(problem));
            }
            triangles.to_vec()
        }
    }))
}
