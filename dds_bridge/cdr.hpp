// CDR: Fast CDR's plain XCDR1 encoding behind the few calls that a member table needs, for Fast CDR 1 and 2.
// Private to dds_bridge; lives on the caller's stack, over the caller's buffer.
// Any thread; calls throw eprosima::fastcdr's exceptions when the buffer is too short.
#pragma once

#include <fastcdr/Cdr.h>
#include <fastcdr/FastBuffer.h>

#include <cstddef>
#include <cstdint>
#include <span>

namespace stationd::bus {

class CdrStream {
 public:
  enum class Endian : std::uint8_t { big, little };

  /// Over the bytes behind the encapsulation header: alignment counts from the first of them.
  CdrStream(std::span<std::byte> bytes, Endian endian)
      : size_(bytes.size()), buffer_(reinterpret_cast<char*>(bytes.data()), bytes.size()),
#if __has_include(<fastcdr/CdrEncoding.hpp>)
        cdr_(buffer_, endianness(endian), eprosima::fastcdr::CdrVersion::XCDRv1) {
  }
#else
        cdr_(buffer_, endianness(endian), eprosima::fastcdr::Cdr::DDS_CDR) {
  }
#endif
  CdrStream(const CdrStream&) = delete;
  CdrStream& operator=(const CdrStream&) = delete;

  template <class T> void put(T value) { cdr_ << value; }
  template <class T> void get(T& value) { cdr_ >> value; }

#if __has_include(<fastcdr/CdrEncoding.hpp>)
  void put_chars(const char* chars, std::size_t count) { cdr_.serialize_array(chars, count); }
  void get_chars(char* chars, std::size_t count) { cdr_.deserialize_array(chars, count); }
  std::size_t position() const { return cdr_.get_serialized_data_length(); }
#else
  void put_chars(const char* chars, std::size_t count) { cdr_.serializeArray(chars, count); }
  void get_chars(char* chars, std::size_t count) { cdr_.deserializeArray(chars, count); }
  std::size_t position() const { return cdr_.getSerializedDataLength(); }
#endif
  std::size_t remaining() const { return size_ - position(); }

 private:
  static eprosima::fastcdr::Cdr::Endianness endianness(Endian endian) {
    return endian == Endian::big ? eprosima::fastcdr::Cdr::BIG_ENDIANNESS
                                 : eprosima::fastcdr::Cdr::LITTLE_ENDIANNESS;
  }

  std::size_t size_;
  eprosima::fastcdr::FastBuffer buffer_;
  eprosima::fastcdr::Cdr cdr_;
};

}  // namespace stationd::bus
