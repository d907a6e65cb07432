//! The meshes of a scene with their transformations.

use glam::{DAffine3, DMat3, DMat4, DQuat, DVec3, DVec4};

use crate::io::error::Fault;
use crate::io::glb::entry::Entry;

/// A mesh in its place.
pub(super) struct Instance {
    pub(super) mesh: usize,
    pub(super) to_scene: DAffine3,
}

/// The meshes of the scene that the file shows first, in the order of its nodes.
pub(super) fn instances(root: &Entry<'_>, notes: &mut Vec<String>) -> Result<Vec<Instance>, Fault> {
    let scenes = root.list("scenes")?.len();
    let nodes = root.list("nodes")?.len();
    if scenes == 0 {
        let meshes = root.list("meshes")?.len();
        if nodes > 0 {
            notes.push("there is no scene: meshes are read without transformations".to_owned());
        }
        let identity = |mesh| Instance { mesh, to_scene: DAffine3::IDENTITY };
        return Ok((0..meshes).map(identity).collect());
    }
    if scenes > 1 {
        notes.push(format!("one of {scenes} scenes is read"));
    }
    let scene = root.at("scenes", root.optional_count("scene")?.unwrap_or(0))?;
    let mut instances = Vec::new();
    let mut seen = vec![false; nodes];
    let mut skins = 0;
    let mut stack = Vec::new();
    let push = |stack: &mut Vec<_>, of: &Entry<'_>, key, to_scene| {
        for child in of.list(key)?.iter().rev() {
            stack.push((child.count()?, to_scene));
        }
        Ok::<_, Fault>(())
    };
    push(&mut stack, &scene, "nodes", DAffine3::IDENTITY)?;
    while let Some((node, parent)) = stack.pop() {
        let entry = root.at("nodes", node)?;
        if std::mem::replace(&mut seen[node], true) {
            return Err(entry.fault("a node in one place of the scene", "it in two"));
        }
        let to_scene = match placement(&entry)? {
            Some(to_parent) => parent * to_parent,
            None => parent,
        };
        if let Some(mesh) = entry.optional_count("mesh")? {
            instances.push(Instance { mesh, to_scene });
            skins += usize::from(entry.get("skin").is_some());
        }
        push(&mut stack, &entry, "children", to_scene)?;
    }
    if skins > 0 {
        notes.push(format!("the skins of {skins} meshes are ignored"));
    }
    Ok(instances)
}

/// The transformation of a node into the space of its parent, if it has one.
fn placement(node: &Entry<'_>) -> Result<Option<DAffine3>, Fault> {
    if let Some(matrix) = node.numbers::<16>("matrix")? {
        let matrix = DMat4::from_cols_array(&matrix);
        if matrix.row(3) != DVec4::W {
            return Err(
                node.fault("a matrix whose last row is 0, 0, 0, 1", matrix.row(3).to_string())
            );
        }
        return Ok(Some(DAffine3::from_mat4(matrix)));
    }
    let translation = node.numbers("translation")?;
    let rotation = node.numbers::<4>("rotation")?;
    let scale = node.numbers("scale")?;
    if translation.is_none() && rotation.is_none() && scale.is_none() {
        return Ok(None);
    }
    let linear = match rotation {
        Some(rotation) => {
            let length = DVec4::from(rotation).length();
            if !(length.is_finite() && length > 0.0) {
                return Err(node.fault("a rotation as a unit quaternion", format!("{rotation:?}")));
            }
            DMat3::from_quat(DQuat::from_vec4(DVec4::from(rotation) / length))
        }
        None => DMat3::IDENTITY,
    };
    let scale = scale.map_or(DMat3::IDENTITY, |scale| DMat3::from_diagonal(DVec3::from(scale)));
    let translation = translation.map_or(DVec3::ZERO, DVec3::from);
    Ok(Some(DAffine3 { matrix3: linear * scale, translation }))
}
