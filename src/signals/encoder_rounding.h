// How an encoder makes a whole number of counts of an angle.
#pragma once

namespace breakwater {

enum class EncoderRounding {
  nearest,  ///< to the nearest count: off by half a count at most
  truncate  ///< towards 0, as Eq. 4.23's largest error of a whole count says
};

}  // namespace breakwater
