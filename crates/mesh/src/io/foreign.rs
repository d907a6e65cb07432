//! Kinds of files that are not meshes, or meshes in formats that are not read.

/// Programs that read the other formats.
const VTK: &str = "`meshio convert` or ParaView";
const PARAVIEW: &str = "ParaView";
const MESHIO: &str = "`meshio convert` or Gmsh";
const BLENDER: &str = "Blender";
const CAD: &str = "FreeCAD or Gmsh";

/// Kinds by their first bytes, with a program that turns a mesh into a format that is read.
const MAGIC: [(&[u8], &str, &str); 31] = [
    (b"# vtk DataFile", "a VTK legacy file", VTK),
    (b"Kaydara FBX Binary", "a binary FBX file", BLENDER),
    (b"; FBX", "an FBX file in text", BLENDER),
    (b"BLENDER", "a Blender file", BLENDER),
    (b"PXR-USDC", "a binary USD file", BLENDER),
    (b"#usda", "a USD file in text", BLENDER),
    (b"#VRML", "a VRML file", "MeshLab"),
    (b"#X3D", "an X3D file", "MeshLab"),
    (b"ISO-10303-21", "a STEP file of CAD surfaces", CAD),
    (b"# .PCD", "points without faces of the Point Cloud Library (PCD)", "CloudCompare"),
    (b"DRACO", "a mesh compressed by Draco", "`draco_decoder`"),
    (b"$MeshFormat", "a Gmsh file", MESHIO),
    (b"MeshVersionFormatted", "a Medit file", MESHIO),
    (b"3D Geometry File Format", "a Rhino file", "Rhino or `rhino3dm`"),
    (b"\x89HDF", "an HDF5 file", VTK),
    (b"\x93NUMPY", "a NumPy array", ""),
    (b"OpenCTM", "an OpenCTM file", "MeshLab"),
    (b"\xd0\xcf\x11\xe0", "an OLE document", ""),
    (b"\x89PNG", "a PNG image", ""),
    (b"\xff\xd8\xff", "a JPEG image", ""),
    (b"GIF8", "a GIF image", ""),
    (b"%PDF", "a PDF document", ""),
    (b"7z\xbc\xaf", "a 7z archive", ""),
    (b"Rar!", "a RAR archive", ""),
    (b"\xfd7zXZ", "xz-compressed", ""),
    (b"BZh", "bzip2-compressed", ""),
    (b"\x28\xb5\x2f\xfd", "zstd-compressed", ""),
    (b"\xff\xfe", "UTF-16 text", ""),
    (b"\xfe\xff", "UTF-16 text", ""),
    (b"version https://git-lfs", "a Git LFS pointer", ""),
    (b"PK\x03\x04", "a ZIP archive", ""),
];

/// Archives by the name of a file in them.
const PACKED: [(&[u8], &str, &str); 4] = [
    (b"3D/3dmodel.model", "a 3MF file", "MeshLab or Blender"),
    (b"3D/", "a 3MF file", "MeshLab or Blender"),
    (b".usdc", "a USDZ archive", BLENDER),
    (b".usda", "a USDZ archive", BLENDER),
];

/// XML by an element near its beginning.
const XML: [(&[u8], &str, &str); 14] = [
    (b"\"UnstructuredGrid\"", "a VTK unstructured grid (VTU)", VTK),
    (b"\"PUnstructuredGrid\"", "a VTK unstructured grid in parts (PVTU)", PARAVIEW),
    (b"\"PPolyData\"", "a VTK surface in parts (PVTP)", PARAVIEW),
    (b"\"ImageData\"", "a VTK image (VTI)", PARAVIEW),
    (b"\"StructuredGrid\"", "a VTK structured grid (VTS)", PARAVIEW),
    (b"\"RectilinearGrid\"", "a VTK rectilinear grid (VTR)", PARAVIEW),
    (b"\"vtkMultiBlockDataSet\"", "a VTK list of blocks (VTM)", PARAVIEW),
    (b"<VTKFile", "a VTK file of another type than PolyData", PARAVIEW),
    (b"<COLLADA", "a COLLADA file (DAE)", BLENDER),
    (b"<X3D", "an X3D file", "MeshLab"),
    (b"<Xdmf", "an XDMF file", VTK),
    (b"<amf", "an AMF file", "FreeCAD"),
    (b"<svg", "an SVG image", ""),
    (b"<", "HTML or XML", ""),
];

/// The bytes in which names of files and elements are looked for.
const NEAR: usize = 4096;

/// The kind of a file of a known other format, and a program that converts it.
pub(super) fn kind(bytes: &[u8]) -> Option<String> {
    let near = &bytes[..bytes.len().min(NEAR)];
    let within = |part: &[u8]| near.windows(part.len()).any(|window| window == part);
    let starts = |magic: &[u8]| bytes.starts_with(magic);
    let find = |all: &[(&[u8], &'static str, &'static str)], is: &dyn Fn(&[u8]) -> bool| {
        all.iter().find(|(mark, ..)| is(mark)).map(|&(_, kind, reader)| (kind, reader))
    };
    let (kind, reader) = match bytes.trim_ascii_start() {
        [b'<', ..] => find(&XML, &within),
        [b'P', b'K', 3, 4, ..] => find(&PACKED, &within).or_else(|| find(&MAGIC, &starts)),
        _ => find(&MAGIC, &starts),
    }?;
    Some(match reader {
        "" => kind.to_owned(),
        reader => format!("{kind}: {reader} can turn it into PLY"),
    })
}

#[cfg(test)]
mod tests {
    use crate::io::Reader;
    use crate::io::tests::refusal;

    /// Under their own names and under that of a format that is read.
    #[test]
    fn other_formats_are_named_with_a_program_that_reads_them() {
        let xml = |kind: &str| {
            format!("<?xml version=\"1.0\"?>\n<VTKFile type=\"{kind}\" version=\"0.1\">\n")
                .into_bytes()
        };
        let zip = |name: &str| [b"PK\x03\x04\x14\0", &[0; 24][..], name.as_bytes()].concat();
        for (name, bytes, kind, reader) in [
            ("a.vtu", xml("UnstructuredGrid"), "(VTU)", "`meshio convert` or ParaView"),
            ("a.pvtu", xml("PUnstructuredGrid"), "(PVTU)", "ParaView"),
            ("a.pvtp", xml("PPolyData"), "(PVTP)", "ParaView"),
            ("a.vti", xml("ImageData"), "(VTI)", "ParaView"),
            ("a.vts", xml("StructuredGrid"), "(VTS)", "ParaView"),
            ("a.vth", xml("HyperTreeGrid"), "of another type than PolyData", "ParaView"),
            ("a.vtk", b"# vtk DataFile Version 3.0\nx\nASCII\n".to_vec(), "VTK legacy", "meshio"),
            ("a.fbx", b"Kaydara FBX Binary  \0\x1a\0".to_vec(), "binary FBX", "Blender"),
            ("a.fbx", b"; FBX 7.3.0 project file\n".to_vec(), "FBX file in text", "Blender"),
            ("a.3mf", zip("3D/3dmodel.model"), "a 3MF file", "MeshLab"),
            ("a.usdz", zip("a.usdc"), "a USDZ archive", "Blender"),
            ("a.step", b"ISO-10303-21;\nHEADER;\n".to_vec(), "a STEP file", "FreeCAD"),
            ("a.dae", b"<?xml version='1.0'?>\n<COLLADA xmlns=''>".to_vec(), "(DAE)", "Blender"),
            ("a.usda", b"#usda 1.0\n".to_vec(), "a USD file in text", "Blender"),
            ("a.usdc", b"PXR-USDC\0\0".to_vec(), "a binary USD", "Blender"),
            ("a.blend", b"BLENDER-v300".to_vec(), "a Blender file", "Blender"),
            ("a.drc", b"DRACO\x02\x02".to_vec(), "by Draco", "`draco_decoder`"),
        ] {
            for (name, begins) in [
                (name, "expected one of the formats OBJ, PLY"),
                ("", "expected one of the formats OBJ, PLY"),
                ("a.ply", "the name says PLY, but the content is"),
                ("a.vtp", "the name says VTP, but the content is"),
            ] {
                let found = refusal(name, &bytes, &Reader::default());
                for part in [begins, kind, reader, "can turn it into PLY"] {
                    assert!(found.contains(part), "{part}: {found}");
                }
            }
        }
    }
}
