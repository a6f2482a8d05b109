// Data that a page carries with it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

namespace breakwater {

/// RFC 4648, padded.
std::string base64(const void* bytes, std::size_t size);

/// Bytes as base64 of a zlib stream (RFC 1950), which browsers call "deflate".
std::string packed_bytes(std::span<const std::uint8_t> bytes);

/// JSON text that may stand within <script>: no '<' is left in it.
std::string script_safe(std::string json);

}  // namespace breakwater
