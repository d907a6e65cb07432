//! Pictures of triangle meshes: rasteriser, colour maps, plots, composed figures.
