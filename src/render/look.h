// How much trouble a picture is worth.
#pragma once

namespace breakwater {

/// Of a texture that is drawn smaller than it is, and so of the pattern in the distance.
enum class TextureFilter {
  linear,    ///< of the texture itself: too fine a pattern is drawn by chance
  bilinear,  ///< of the nearest of its smaller copies
  trilinear  ///< between two of them
};

/// What is drawn beyond plain lit geometry.
struct Look {
  bool shadows = true;
  bool sky = true;  ///< the model's own skybox, if it has one
  bool reflections = false;
  TextureFilter textures = TextureFilter::bilinear;
  int shadow_map = 1024;  ///< side of the shadow map, in texels
  int samples = 1;        ///< per pixel and direction: 4 draws 16 times as many pixels
};

/// For videos that must be quick.
inline constexpr Look kFastLook{.shadows = false, .sky = false, .textures = TextureFilter::linear};
/// For videos.
inline constexpr Look kFullLook{};
/// For print, whatever it takes.
inline constexpr Look kPrintLook{
    .reflections = true, .textures = TextureFilter::trilinear, .shadow_map = 4096, .samples = 4};

}  // namespace breakwater
