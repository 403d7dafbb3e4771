#define XXH_INLINE_ALL
#include <xxhash.h>
#include <zstd.h>

#include <cstdio>
#include <string>
#include <string_view>
#include <vector>

#include "files/byte_reader.h"
#include "files/byte_writer.h"
#include "files/write_whole.h"
#include "mallow/errors.h"
#include "mallow/files.h"

/// A checkpoint file. Numbers are little-endian, hashes are XXH3's 64 bits; what chunks hold lies in the
/// order of bytes of the machine.
///
///   magic                8 bytes
///   version              u32   k_version
///   byte order           4 bytes, k_byte_order as it lies in memory
///   chunks               u32   at most k_most_chunks
///   for each chunk       u32 length of the name, at most k_longest_name; the name;
///                        u64 size, at most k_largest_chunk; u64 size as stored; u64 hash as stored
///   hash                 u64   of all above
///   for each chunk       a frame of zstd
///   size of the file     u64
///   magic                8 bytes
namespace mallow {
namespace {

constexpr std::string_view k_magic =
    "\x89MALLOW\n";  // no text, and no longer itself where ends of lines were changed
constexpr std::uint32_t k_version = 1;
constexpr std::uint32_t k_byte_order = 0x01020304;
constexpr std::uint32_t k_most_chunks = 256;
constexpr std::uint32_t k_longest_name = 64;
constexpr std::uint64_t k_largest_chunk = std::uint64_t{1} << 32;
/// Of coordinates no level saves more than a tenth; the fastest is ten times as fast as the usual one.
constexpr int k_compression_level = 1;

std::string hash_text(std::uint64_t hash) {
  char text[24];
  std::snprintf(text, sizeof text, "0x%016llx", static_cast<unsigned long long>(hash));
  return text;
}

std::string compressed(const std::filesystem::path& file, const std::string& bytes) {
  std::string stored(ZSTD_compressBound(bytes.size()), '\0');
  const std::size_t size =
      ZSTD_compress(stored.data(), stored.size(), bytes.data(), bytes.size(), k_compression_level);
  if (ZSTD_isError(size)) fail_file(file, std::string("cannot be compressed: ") + ZSTD_getErrorName(size));
  stored.resize(size);
  return stored;
}

/// Where a chunk stands in a file, and what is said of it there.
struct Entry {
  std::string name;
  std::uint64_t size = 0, stored = 0, hash = 0;
};

class CheckpointReader {
 public:
  CheckpointReader(const std::filesystem::path& file, std::string_view bytes)
      : file_(file), bytes_(bytes), reader_(bytes, std::endian::little) {}

  SavedState read() {
    read_beginning();
    const std::vector<Entry> entries = read_table();
    require_whole(entries);
    SavedState state;
    for (const Entry& entry : entries) state.chunks.push_back({entry.name, payload(entry)});
    return state;
  }

 private:
  std::size_t position() const { return bytes_.size() - reader_.remaining(); }

  std::string_view take(std::uint64_t count) {
    const std::string_view taken = bytes_.substr(position(), static_cast<std::size_t>(count));
    if (!reader_.skip(count)) fail_file(file_, "is cut off: it ends after " + counted(bytes_.size(), "byte"));
    return taken;
  }
  template <class T>
  T number() {
    const std::optional<T> value = reader_.read<T>();
    if (!value) fail_file(file_, "is cut off: it ends after " + counted(bytes_.size(), "byte"));
    return *value;
  }
  /// A number of the table, which its hash has not vouched for yet.
  template <class T>
  T number(T most, const char* what) {
    const T value = number<T>();
    if (value > most)
      fail_file(file_, std::string("is damaged: ") + what + " is " + std::to_string(value) + ", at most " +
                           std::to_string(most) + " is allowed");
    return value;
  }

  void read_beginning() {
    if (!bytes_.starts_with(k_magic.substr(0, bytes_.size())))
      fail_file(file_, "is not a checkpoint of mallow: it does not begin like one");
    take(k_magic.size());
    const auto version = number<std::uint32_t>();
    if (version != k_version)
      fail_file(file_, "is of version " + std::to_string(version) +
                           " of the format; this build of mallow reads " + std::to_string(k_version));
    const std::string_view order = take(sizeof k_byte_order);
    if (std::memcmp(order.data(), &k_byte_order, sizeof k_byte_order) != 0)
      fail_file(file_, "is damaged, or was written on a machine with the other byte order");
  }

  std::vector<Entry> read_table() {
    std::vector<Entry> entries(number(k_most_chunks, "the number of chunks"));
    for (Entry& entry : entries) {
      entry.name = take(number(k_longest_name, "the length of a name"));
      entry.size = number(k_largest_chunk, "the size of a chunk");
      entry.stored = number<std::uint64_t>();
      entry.hash = number<std::uint64_t>();
    }
    const std::uint64_t hash = XXH3_64bits(bytes_.data(), position());
    const auto expected = number<std::uint64_t>();
    if (hash != expected)
      fail_file(file_, "the table of chunks is damaged: its hash is " + hash_text(hash) + ", expected " +
                           hash_text(expected));
    return entries;
  }

  /// From here on the table is as it was written.
  void require_whole(const std::vector<Entry>& entries) {
    std::uint64_t size = position() + sizeof size + k_magic.size();
    for (const Entry& entry : entries) {
      if (entry.stored > bytes_.size())
        fail_file(file_, "is cut off: chunk '" + entry.name + "' alone has " + counted(entry.stored, "byte") +
                             ", the file " + std::to_string(bytes_.size()));
      size += entry.stored;
    }
    if (size != bytes_.size())
      fail_file(file_, std::string(size > bytes_.size() ? "is cut off" : "has bytes after its end") + ": " +
                           counted(bytes_.size(), "byte") + ", expected " + std::to_string(size));
    ByteReader end(bytes_.substr(bytes_.size() - k_magic.size() - sizeof size), std::endian::little);
    if (*end.read<std::uint64_t>() != size || !bytes_.ends_with(k_magic))
      fail_file(file_, "is damaged: it does not end like a checkpoint");
  }

  std::string payload(const Entry& entry) {
    const std::string_view stored = take(entry.stored);
    const auto fail = [&](const std::string& why) {
      fail_file(file_, "chunk '" + entry.name + "' is damaged: " + why);
    };
    const std::uint64_t hash = XXH3_64bits(stored.data(), stored.size());
    if (hash != entry.hash) fail("its hash is " + hash_text(hash) + ", expected " + hash_text(entry.hash));
    // A file that was made to do harm can have right hashes.
    if (ZSTD_getFrameContentSize(stored.data(), stored.size()) != entry.size) fail("its sizes differ");
    std::string bytes(static_cast<std::size_t>(entry.size), '\0');
    const std::size_t size = ZSTD_decompress(bytes.data(), bytes.size(), stored.data(), stored.size());
    if (ZSTD_isError(size)) fail(ZSTD_getErrorName(size));
    if (size != bytes.size()) fail("its sizes differ");
    return bytes;
  }

  const std::filesystem::path& file_;
  std::string_view bytes_;
  ByteReader reader_;
};

void require_writable(const std::filesystem::path& file, const SavedState& state) {
  if (state.chunks.size() > k_most_chunks)
    fail_file(file, counted(state.chunks.size(), "chunk") + " are not allowed: at most " +
                        std::to_string(k_most_chunks));
  for (const Chunk& chunk : state.chunks)
    if (chunk.name.size() > k_longest_name || chunk.bytes.size() > k_largest_chunk)
      fail_file(file, "chunk '" + chunk.name + "' is not allowed: names of at most " +
                          std::to_string(k_longest_name) + " bytes and sizes of at most " +
                          std::to_string(k_largest_chunk));
}

}  // namespace

void write_checkpoint(const std::filesystem::path& file, const SavedState& state) {
  require_writable(file, state);
  std::string bytes(k_magic);
  append_little_endian(bytes, k_version);
  bytes.append(reinterpret_cast<const char*>(&k_byte_order), sizeof k_byte_order);
  append_little_endian(bytes, static_cast<std::uint32_t>(state.chunks.size()));
  std::string payloads;
  for (const Chunk& chunk : state.chunks) {
    const std::string stored = compressed(file, chunk.bytes);
    append_little_endian(bytes, static_cast<std::uint32_t>(chunk.name.size()));
    bytes += chunk.name;
    append_little_endian(bytes, static_cast<std::uint64_t>(chunk.bytes.size()));
    append_little_endian(bytes, static_cast<std::uint64_t>(stored.size()));
    append_little_endian(bytes, static_cast<std::uint64_t>(XXH3_64bits(stored.data(), stored.size())));
    payloads += stored;
  }
  append_little_endian(bytes, static_cast<std::uint64_t>(XXH3_64bits(bytes.data(), bytes.size())));
  bytes += payloads;
  const std::uint64_t size = bytes.size() + sizeof size + k_magic.size();
  append_little_endian(bytes, size);
  bytes += k_magic;
  require_readable_size(file, size);
  write_whole_keeping(file, bytes, previous_checkpoint(file));
}

SavedState read_checkpoint(const std::filesystem::path& file) {
  const std::string bytes = read_whole_file(file);
  return CheckpointReader(file, bytes).read();
}

std::filesystem::path previous_checkpoint(const std::filesystem::path& file) {
  std::filesystem::path previous = file;
  return previous += ".previous";
}

}  // namespace mallow
