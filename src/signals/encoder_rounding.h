// Conversion of a position to a whole number of counts.
#pragma once

namespace breakwater {

enum class EncoderRounding {
  nearest,  ///< to the nearest count: an error of at most half a count
  truncate  ///< towards 0: an error of up to a whole count, as in Eq. 4.23
};

}  // namespace breakwater
