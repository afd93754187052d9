// A user's fragment shader, and the triangle over the frame that it runs on.

#import "../../shaders/fullscreen.wgsl"
#import interface "effect"
