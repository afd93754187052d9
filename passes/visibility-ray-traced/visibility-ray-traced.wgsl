// Computes the visibility of each virtual light with a ray: exact. [SMC-IR §5.4]
//
// Threads that run together all take as many loop iterations as the longest of them: groups of eight rays through 10⁵
// triangles took up to the number below.

#input lights: VirtualLights optional // Not read: here so that the pass type takes the place of one that renders maps of
    // them.
#output visibility: Visibility(iterations: 400) module "shaders/visibility-ray-traced.wgsl" // Only the module that traces a ray.
