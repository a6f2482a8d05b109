// How much trouble a picture is worth.
#pragma once

namespace breakwater {

/// What is drawn beyond plain lit geometry.
struct Look {
  bool shadows = true;
  bool sky = true;  ///< the model's own skybox, if it has one
  bool reflections = false;
  int shadow_map = 1024;  ///< side of the shadow map, in texels
  int samples = 1;        ///< per pixel and direction: 4 draws 16 times as many pixels
};

/// For videos that must be quick.
inline constexpr Look kFastLook{.shadows = false, .sky = false};
/// For videos.
inline constexpr Look kFullLook{};
/// For print, whatever it takes.
inline constexpr Look kPrintLook{.reflections = true, .shadow_map = 4096, .samples = 4};

}  // namespace breakwater
