//! The CPU reference of `shaders/clustering.wgsl`: the same functions, by the same names. Also a reflective shadow map
//! in `f64`, for the passes that cluster one.

use glam::{DVec2, DVec3, IVec2, UVec2, UVec3, Vec3, Vec4, uvec3, vec3};

/// A texel that saw a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Texel {
    /// World space \[m\].
    pub position: DVec3,
    /// Unit; 0 where the map has none.
    pub normal: DVec3,
    /// \[W\]
    pub flux: DVec3,
    /// \[m²\]
    pub area: f64,
    /// ρ; 1 where no importance is linked.
    pub importance: f64,
}

impl Texel {
    /// Reads a texel as the textures of a map hold it; `None` where it saw nothing.
    pub fn read(position: [f32; 4], normal: [f32; 3], flux: [f32; 4], importance: f32) -> Option<Texel> {
        let [r, g, b, area] = flux;
        is_lit(position.into()).then(|| Texel {
            position: Vec4::from(position).truncate().as_dvec3(),
            normal: direction_of(normal.into()),
            flux: flux_of(vec3(r, g, b)),
            area: weight_of(area),
            importance: weight_of(importance),
        })
    }
}

/// A reflective shadow map.
#[derive(Clone, Debug)]
pub struct Texels {
    /// Texels of a layer.
    pub size: UVec2,
    /// Texels through rows and layers; `None` where nothing was seen.
    pub texels: Vec<Option<Texel>>,
}

impl Texels {
    /// Returns column, row and layer of a texel.
    pub fn place(&self, index: usize) -> UVec3 {
        let (width, height) = (self.size.x as usize, self.size.y as usize);
        uvec3((index % width) as u32, (index / width % height) as u32, (index / (width * height)) as u32)
    }

    /// Returns the texels that saw something: index, column, row and layer, and what they hold.
    pub fn lit(&self) -> impl Iterator<Item = (usize, UVec3, &Texel)> {
        let lit = self.texels.iter().enumerate().filter_map(|(i, texel)| Some((i, texel.as_ref()?)));
        lit.map(|(i, texel)| (i, self.place(i), texel))
    }
}

/// Returns what can be summed: NaN and negative values count as 0, infinity as the greatest number.
pub fn weight_of(x: f32) -> f64 {
    if x > 0.0 { f64::from(x.min(f32::MAX)) } else { 0.0 }
}

/// Returns whether a texel of the map's positions saw a surface.
pub fn is_lit(position: Vec4) -> bool {
    position.truncate().is_finite() && weight_of(position.w) > 0.0
}

/// Returns flux whose channels can be summed.
pub fn flux_of(flux: Vec3) -> DVec3 {
    DVec3::from(flux.to_array().map(weight_of))
}

/// Returns the unit vector in this direction; 0 where there is none.
pub fn direction_of(v: Vec3) -> DVec3 {
    let length2 = v.as_dvec3().length_squared();
    if v.is_finite() && length2 > 1e-30 && length2 < 1e30 { v.as_dvec3().normalize() } else { DVec3::ZERO }
}

/// Texels from `low` to before `high`, in one layer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Window {
    /// The first column and row.
    pub low: UVec2,
    /// The end of the columns and rows.
    pub high: UVec2,
}

impl Window {
    /// Returns whether a texel is in the window.
    pub fn holds(&self, texel: UVec2) -> bool {
        texel.cmpge(self.low).all() && texel.cmplt(self.high).all()
    }
}

/// Returns the window of a cluster at `uv` \[texels\].
pub fn window_of(uv: DVec2, side: u32, size: UVec2) -> Window {
    if side == 0 {
        return Window { low: UVec2::ZERO, high: size };
    }
    let first = uv.floor().as_ivec2() - (side / 2) as i32;
    let inside = |at: IVec2| at.clamp(IVec2::ZERO, size.as_ivec2()).as_uvec2();
    Window { low: inside(first), high: inside(first + side as i32) }
}
