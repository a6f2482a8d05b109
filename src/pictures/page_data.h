// Data inside a page.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

namespace breakwater {

/// Base64 by RFC 4648, padded.
std::string base64(const void* bytes, std::size_t size);

/// Bytes as base64 of a zlib stream (RFC 1950), the format "deflate" of browsers.
std::string packed_bytes(std::span<const std::uint8_t> bytes);

}  // namespace breakwater
