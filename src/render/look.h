// The quality of a picture.
#pragma once

namespace breakwater {

/// Filters for textures drawn smaller than they are. Magnified textures are bilinear.
enum class Minification {
  no_mipmaps,      ///< bilinear; patterns finer than a pixel alias
  nearest_mipmap,  ///< bilinear in the nearest mipmap
  trilinear        ///< between two mipmaps
};

/// The features and the quality of a picture.
struct Look {
  bool shadows = true;
  bool sky = true;  ///< the model's own skybox, if it has one
  bool reflections = false;
  Minification minification = Minification::nearest_mipmap;
  int shadow_map = 1024;  ///< side of the shadow map, in texels
  int samples = 1;        ///< per pixel and direction: 4 draws 16 times as many pixels
};

/// For quick videos.
inline constexpr Look kFastLook{
    .shadows = false, .sky = false, .minification = Minification::no_mipmaps};
/// For videos.
inline constexpr Look kFullLook{};
/// For print, however long it takes.
inline constexpr Look kPrintLook{
    .reflections = true, .minification = Minification::trilinear, .shadow_map = 4096, .samples = 4};

}  // namespace breakwater
