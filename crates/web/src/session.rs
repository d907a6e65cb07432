//! A session: the requests of a page.

use anyhow::{Result, bail};
use serde_json::Value;

use crate::answer::Answer;
use crate::meshes::Meshes;
use crate::request::Request;
use crate::{change, file, tables, values};

/// The meshes of a page, and what later requests can use again.
#[derive(Default)]
pub struct Session {
    meshes: Meshes,
}

impl Session {
    /// A session without meshes.
    pub fn new() -> Self {
        Self::default()
    }

    /// Answers a request.
    ///
    /// # Errors
    ///
    /// The errors of the program in one line; the meshes are as before.
    pub fn call(&mut self, request: &[u8], bytes: &[u8]) -> Result<Answer> {
        let request = Request::new(request, bytes)?;
        let meshes = &mut self.meshes;
        match request.text("verb")? {
            "tables" => Ok(tables::all().into()),
            "sample" => file::sample(meshes, &request),
            "read" => file::read(meshes, &request),
            "write" => file::write(meshes, &request),
            "losses" => file::losses(meshes, &request),
            "adopt" => file::adopt(meshes, &request),
            "others" => file::others(meshes, &request),
            "mesh" => file::mesh(meshes, &request),
            "field" => file::field(meshes, &request),
            "drop" => {
                meshes.forget(request.number("mesh")?);
                Ok(Value::Null.into())
            }
            "info" => values::info(meshes, &request),
            "compare" => values::compare(meshes, &request),
            "curvature" => values::curvature(meshes, &request),
            "distance" => values::distance(meshes, &request),
            "spectrum" => values::spectrum(meshes, &request),
            "mode" => values::mode(meshes, &request),
            "smooth" => change::smooth(meshes, &request),
            "denoise" => change::denoise(meshes, &request),
            "noise" => change::noise(meshes, &request),
            "reconstruct" => change::reconstruct(meshes, &request),
            "repair" => change::repair(meshes, &request),
            verb => bail!("there is no verb {verb:?}"),
        }
    }
}
