// Declares every virtual light visible from everywhere.

#input lights: VirtualLights optional // Not read: here so that the pass type takes the place of one that renders maps of
    // them.
#output visibility: Visibility module "shaders/visibility-none.wgsl" // Only the module that returns 1.
#exact maps: pass visibility-ray-traced // A ray for each light and pixel.
