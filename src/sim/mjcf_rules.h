// Words of MJCF that MuJoCo 3 has beyond MuJoCo 2.2, and their fate.
#pragma once

#include <algorithm>
#include <array>
#include <string_view>

#include <breakwater/plants/xml_file.h>

namespace breakwater::mjcf {

enum class Fate { left_out, approximated, dropped, refused };

// `element` and `attribute` are lists of names, separated by blanks. Without an attribute the rule
// is for the element itself; without an element it is for all actuators and sensors. Nothing is
// lost of a value whose words are all in the list `harmless`: the engine behaves so without it.
struct Rule {
  std::string_view element;
  std::string_view attribute;
  Fate fate;
  std::string_view harmless = "";
  std::string_view words = "";
};

using enum Fate;

inline constexpr std::array kRules = {
    Rule{"option", "ls_tolerance ls_iterations sdf_iterations sdf_initpoints sleep_tolerance",
         left_out},
    Rule{"option", "o_friction actuatorgroupdisable", dropped},
    Rule{"flag", "midphase autoreset nativeccd island invdiscrete", left_out},
    Rule{"flag", "spring damper", dropped, "enable"},
    Rule{"flag", "eulerdamp", approximated, "enable", "Euler damps implicitly"},
    Rule{"flag", "sleep", approximated, "disable", "nothing sleeps"},
    Rule{"flag", "diagexact", approximated, "disable"},
    Rule{"flag", "ipc", refused, "disable"},
    Rule{"size", "memory", left_out},
    Rule{"global", "cameraid orthographic realtime ellipsoidinertia bvactive", left_out},
    Rule{"scale rgba", "frustum bv bvactive", left_out},
    Rule{"compiler", "saveinertial conflict", left_out},
    Rule{"compiler freejoint", "alignfree align", approximated, "false auto",
         "frames are those of the file"},
    Rule{"mesh", "content_type material", left_out},
    Rule{"mesh", "maxhullvert", approximated, "-1", "the hull has all vertices"},
    Rule{"mesh", "inertia", approximated, "legacy", "by the engine's own rule"},
    Rule{"mesh", "builtin params plugin", refused},
    Rule{"material", "metallic roughness", left_out},
    Rule{"layer", "", left_out},
    Rule{"texture", "colorspace content_type nchannel", left_out},
    Rule{"hfield", "content_type", left_out},
    Rule{"hfield", "elevation", refused, "", "heights must be in a file"},
    Rule{"body", "sleep simple fuse", left_out},
    Rule{"joint spatial fixed", "actuatorfrclimited actuatorgravcomp", left_out},
    Rule{"geom", "surfacevel", dropped, "0", "the surface stands still"},
    Rule{"geom pair", "adhesion", dropped, "0"},
    Rule{"pair", "solreffriction", dropped},
    Rule{"site", "mesh", left_out},
    Rule{"camera",
         "projection resolution output focal focalpixel principal principalpixel sensorsize",
         left_out},
    Rule{"light", "type bulbradius intensity range softness texture", left_out},
    Rule{"spatial fixed", "actuatorfrcrange armature", dropped, "0"},
    Rule{"muscle", "tausmooth", approximated, "0"},
    Rule{"general", "actdim", dropped, "1 -1"},
    Rule{"general", "actearly", approximated, "false"},
    Rule{"rangefinder", "camera data", refused},
    Rule{"camprojection jointactuatorfrc tendonactuatorfrc insidesite distance normal fromto "
         "contact e_potential e_kinetic tactile",
         "", dropped},
    Rule{"flexcomp deformable flex flexvert flexstrain", "", refused, "",
         "the engine has no flexible bodies"},
    Rule{"extension plugin", "", refused, "", "the engine has no plugins"},
    Rule{"dcmotor", "", refused, "", "use a <motor> and the keys drive.… of the axis"},
    Rule{"pid", "", refused, "", "use a <motor> and a controller of the axis"},
    Rule{"orientation", "", refused},
    Rule{"composite", "vertex initial curve size quat", refused, "", "the engine has no cables"},
    Rule{"", "delay", refused, "0", "use control.delay_s"},
    Rule{"", "interval", refused, "0", "use control.period_s"},
    Rule{"", "nsample interp", left_out},
    Rule{"", "input velrange ffrange damping armature", dropped, "0"},
};

inline bool has_word(std::string_view list, std::string_view word) {
  return std::ranges::count(words_of(list), word) > 0;
}

// A keyword that the engine does not know; without `value`, an attribute with another name there.
// With the fate `refused`, `becomes` has the reason.
struct Keyword {
  std::string_view element;
  std::string_view attribute;
  std::string_view value;
  std::string_view becomes;
  Fate fate;
};

inline constexpr std::array kKeywords = {
    Keyword{"option", "integrator", "implicitfast", "implicit", approximated},
    Keyword{"option", "integrator", "discrete", "implicit", approximated},
    Keyword{"general", "dyntype", "filterexact", "filter", approximated},
    Keyword{"site", "type", "mesh", "sphere", left_out},
    Keyword{"geom", "type", "sdf", "the engine has no signed distance fields", refused},
    Keyword{"composite", "type", "cable", "the engine has no cables", refused},
    Keyword{"option", "ccd_tolerance", "", "mpr_tolerance", left_out},
    Keyword{"option", "ccd_iterations", "", "mpr_iterations", left_out},
    Keyword{"lengthrange", "interval", "", "inteval", left_out},
};

}  // namespace breakwater::mjcf
