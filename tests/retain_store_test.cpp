// The retained store: whatever happens to its files, a record is whole and of one save, or there is none.
#include <doctest/doctest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <csignal>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <vector>

#include "daemon/retain_store.hpp"
#include "scan/error.hpp"

namespace stationd {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kLayout = 0x1234;
constexpr std::size_t kSlots = 6;

/// A directory of the test's own, gone with it.
class Directory {
 public:
  Directory() {
    // In memory where there is such a place: the tests judge the bytes, not the disk.
    const fs::path base = fs::is_directory("/dev/shm") ? fs::path("/dev/shm") : fs::temp_directory_path();
    std::string name = (base / "stationd-retain-XXXXXX").string();
    REQUIRE(mkdtemp(name.data()) != nullptr);
    path = name;
  }
  Directory(const Directory&) = delete;
  Directory& operator=(const Directory&) = delete;
  ~Directory() {
    fs::permissions(path, fs::perms::owner_all);
    fs::remove_all(path);
  }
  fs::path file(int index) const { return path / ("C.ST.retained." + std::to_string(index)); }
  fs::path old(int index) const { return path / ("ST.retained." + std::to_string(index)); }
  fs::path aside(int index) const { return file(index).string() + ".refused"; }
  fs::path path;
};

/// All slots alike: a record mixed from two saves would show.
std::vector<Slot> slots_of(Slot n) { return std::vector<Slot>(kSlots, n); }

RetainStore::Loaded load(const Directory& directory, std::uint64_t layout = kLayout) {
  return RetainStore(directory.path, "C", "ST", layout).load();
}

/// Saves n = 1 .. count, epoch 10.
void save_to(const Directory& directory, Slot count) {
  RetainStore store(directory.path, "C", "ST", kLayout);
  store.load();
  for (Slot n = 1; n <= count; ++n) REQUIRE(store.save(10, slots_of(n)));
}

std::string content(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

void put(const fs::path& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary | std::ios::trunc) << bytes;
}

/// The files as they were after three saves, put back for each damage.
struct Saved {
  explicit Saved(const Directory& d) : directory(d) {
    save_to(directory, 3);
    for (int i = 0; i < 2; ++i) bytes[i] = content(directory.file(i));
  }
  void restore() const {
    for (int i = 0; i < 2; ++i) put(directory.file(i), bytes[i]);
  }
  const Directory& directory;
  std::string bytes[2];
};

TEST_CASE("store that was never written gives nothing and has nothing to complain of [IMG-4]") {
  const Directory directory;
  const auto loaded = load(directory);
  CHECK_FALSE(loaded.record.has_value());
  CHECK(loaded.epoch == 0);
  CHECK(loaded.refused.empty());
}

TEST_CASE("record that was saved is loaded with its epoch [IMG-4]") {
  const Directory directory;
  RetainStore store(directory.path, "C", "ST", kLayout);
  store.load();
  const std::vector<Slot> slots = {0, 1, ~Slot{0}, 42};
  CHECK(store.save(77, slots));
  const auto loaded = load(directory);
  REQUIRE(loaded.record.has_value());
  CHECK(loaded.record->slots == slots);
  CHECK(loaded.record->epoch == 77);
  CHECK(loaded.epoch == 77);
  CHECK(loaded.refused.empty());
}

TEST_CASE("record without slots is a record [IMG-4]") {
  const Directory directory;
  RetainStore store(directory.path, "C", "ST", kLayout);
  CHECK(store.save(5, {}));
  const auto loaded = load(directory);
  REQUIRE(loaded.record.has_value());
  CHECK(loaded.record->slots.empty());
}

TEST_CASE("saves take turns with two files, over restarts, too, and the newest is loaded [IMG-4]") {
  const Directory directory;
  for (Slot n = 1; n <= 20; ++n) {
    RetainStore store(directory.path, "C", "ST", kLayout);
    store.load();
    CHECK(store.save(1, slots_of(2 * n)));
    const std::string before = content(directory.file(0)) + content(directory.file(1));
    CHECK(load(directory).record->slots == slots_of(2 * n));
    CHECK(store.save(1, slots_of(2 * n + 1)));
    CHECK(load(directory).record->slots == slots_of(2 * n + 1));
    CHECK(content(directory.file(0)) + content(directory.file(1)) != before);
  }
  CHECK(content(directory.file(0)).size() == content(directory.file(1)).size());
}

TEST_CASE("newest valid record is never the one written over [IMG-4]") {
  const Directory directory;
  save_to(directory, 3);
  for (int i = 0; i < 2; ++i) {
    const Directory copy;
    fs::copy_file(directory.file(i), copy.file(i));
    const std::string kept = content(copy.file(i));
    RetainStore store(copy.path, "C", "ST", kLayout);
    REQUIRE(store.load().record.has_value());
    CHECK(store.save(10, slots_of(9)));
    CHECK(content(copy.file(i)) == kept);
  }
}

TEST_CASE("stations of one directory do not share a record [IMG-4]") {
  const Directory directory;
  save_to(directory, 2);
  CHECK_FALSE(RetainStore(directory.path, "C", "OTHER", kLayout).load().record.has_value());
}

TEST_CASE("stations of one name of two controllers do not share a record [IMG-4]") {
  const Directory directory;
  save_to(directory, 2);
  RetainStore other(directory.path, "C2", "ST", kLayout);
  CHECK_FALSE(other.load().record.has_value());
  CHECK(other.save(3, slots_of(7)));
  CHECK(load(directory).record->slots == slots_of(2));
  CHECK(RetainStore(directory.path, "C2", "ST", kLayout).load().record->slots == slots_of(7));
}

TEST_CASE("files named without the controller are adopted once, by the first that asks [IMG-4]") {
  const Directory directory;
  save_to(directory, 3);
  for (int i = 0; i < 2; ++i) fs::rename(directory.file(i), directory.old(i));
  const auto loaded = load(directory);
  REQUIRE(loaded.record.has_value());
  CHECK(loaded.record->slots == slots_of(3));
  CHECK(loaded.epoch == 10);
  for (int i = 0; i < 2; ++i) {
    CHECK(loaded.adopted.find(directory.old(i).string() + " as " + directory.file(i).string()) !=
          std::string::npos);
    CHECK_FALSE(fs::exists(directory.old(i)));
  }
  CHECK(load(directory).adopted.empty());
  CHECK_FALSE(RetainStore(directory.path, "C2", "ST", kLayout).load().record.has_value());
}

TEST_CASE("files of the old name whose adoption was cut short are adopted by the next start [IMG-4]") {
  for (int adopted = 0; adopted < 2; ++adopted) {
    const Directory directory;
    save_to(directory, 3);
    fs::rename(directory.file(1 - adopted), directory.old(1 - adopted));
    CHECK(load(directory).record->slots == slots_of(3));
  }
}

TEST_CASE("file of the old name never replaces one of the new [IMG-4]") {
  const Directory directory;
  save_to(directory, 3);
  fs::copy_file(directory.file(1), directory.old(0));
  const auto loaded = load(directory);
  CHECK(loaded.adopted.empty());
  CHECK(loaded.record->slots == slots_of(3));
  CHECK(fs::exists(directory.old(0)));
}

TEST_CASE("every truncation of the newest file gives the older record, of the older one the newest [IMG-4]") {
  const Directory directory;
  const Saved saved(directory);
  const int newest = 0;  // of three saves in turns: 0, 1, 0
  for (int i = 0; i < 2; ++i) {
    for (std::size_t size = 0; size < saved.bytes[i].size(); ++size) {
      saved.restore();
      fs::resize_file(directory.file(i), size);
      const auto loaded = load(directory);
      REQUIRE(loaded.record.has_value());
      REQUIRE(loaded.record->slots == slots_of(i == newest ? 2 : 3));
      REQUIRE(loaded.epoch == 11);
      REQUIRE(loaded.refused.find("C.ST.retained." + std::to_string(i) + " is damaged") != std::string::npos);
      REQUIRE(content(directory.aside(i)) == saved.bytes[i].substr(0, size));
      REQUIRE_FALSE(fs::exists(directory.file(i)));
    }
  }
}

TEST_CASE("every truncation of both files gives no record and says so [IMG-4]") {
  const Directory directory;
  const Saved saved(directory);
  for (std::size_t size = 0; size < saved.bytes[0].size(); ++size) {
    saved.restore();
    fs::resize_file(directory.file(0), size);
    fs::resize_file(directory.file(1), size);
    const auto loaded = load(directory);
    REQUIRE_FALSE(loaded.record.has_value());
    REQUIRE(loaded.epoch == 0);
    REQUIRE_FALSE(loaded.refused.empty());
  }
}

TEST_CASE("thousands of random damages never give a record that was not saved [IMG-4]") {
  const Directory directory;
  const Saved saved(directory);
  std::mt19937_64 random(99);
  int older = 0;
  int none = 0;
  for (int round = 0; round < 6'000; ++round) {
    saved.restore();
    for (int i = 0; i < 2; ++i) {
      std::string bytes = saved.bytes[i];
      for (std::uint64_t hits = random() % 4; hits > 0; --hits)
        bytes[random() % bytes.size()] = static_cast<char>(random());
      if (random() % 8 == 0) bytes += std::string(random() % 40, 'x');
      if (random() % 8 == 0) bytes.resize(random() % bytes.size());
      put(directory.file(i), bytes);
    }
    const auto loaded = load(directory);
    none += !loaded.record;
    if (!loaded.record) continue;
    older += loaded.record->slots == slots_of(2);
    REQUIRE((loaded.record->slots == slots_of(3) || loaded.record->slots == slots_of(2)));
    REQUIRE(loaded.record->epoch == 10);
  }
  CHECK(older > 100);
  CHECK(none > 100);
}

TEST_CASE("file whose halves are of two saves is refused [IMG-4]") {
  const Directory directory;
  const Saved saved(directory);
  const std::size_t size = saved.bytes[0].size();
  int mixed = 0;
  for (std::size_t cut = 0; cut <= size; ++cut) {
    const std::string bytes = saved.bytes[0].substr(0, cut) + saved.bytes[1].substr(cut);
    mixed += bytes != saved.bytes[0] && bytes != saved.bytes[1];
    put(directory.file(0), bytes);
    put(directory.file(1), "");
    const bool whole = bytes == saved.bytes[0] || bytes == saved.bytes[1];
    REQUIRE(load(directory).record.has_value() == whole);
  }
  CHECK(mixed > 20);
}

TEST_CASE("record of another layout is refused and kept aside, its epoch goes on [IMG-4]") {
  const Directory directory;
  const Saved saved(directory);
  const auto loaded = load(directory, kLayout + 1);
  CHECK_FALSE(loaded.record.has_value());
  CHECK(loaded.epoch == 10);
  CHECK(loaded.refused.find("is of another layout, kept aside as") != std::string::npos);
  CHECK(content(directory.aside(0)) == saved.bytes[0]);
  CHECK(content(directory.aside(1)) == saved.bytes[1]);
}

TEST_CASE("store whose files were refused saves and loads again [IMG-4]") {
  const Directory directory;
  save_to(directory, 2);
  RetainStore store(directory.path, "C", "ST", kLayout + 1);
  store.load();
  CHECK(store.save(11, slots_of(5)));
  CHECK(load(directory, kLayout + 1).record->slots == slots_of(5));
}

TEST_CASE("record that grows or shrinks leaves nothing of the longer one behind [IMG-4]") {
  const Directory directory;
  RetainStore store(directory.path, "C", "ST", kLayout);
  for (const std::size_t count : {9UL, 9UL, 2UL, 2UL, 5UL}) {
    CHECK(store.save(1, std::vector<Slot>(count, count)));
    CHECK(load(directory).record->slots == std::vector<Slot>(count, count));
    CHECK(load(directory).refused.empty());
  }
}

TEST_CASE("save that the disk has no room for fails with the reason and keeps the older record [IMG-4]") {
  const Directory directory;
  RetainStore store(directory.path, "C", "ST", kLayout);
  REQUIRE(store.save(1, slots_of(1)));
  struct sigaction ignore {
  }, old_action{};
  ignore.sa_handler = SIG_IGN;
  rlimit old_limit{};
  REQUIRE(sigaction(SIGXFSZ, &ignore, &old_action) == 0);
  REQUIRE(getrlimit(RLIMIT_FSIZE, &old_limit) == 0);
  const rlimit small{50, old_limit.rlim_max};
  REQUIRE(setrlimit(RLIMIT_FSIZE, &small) == 0);
  const bool saved = store.save(1, slots_of(2));
  const std::string error = store.error();
  const auto loaded = load(directory);
  setrlimit(RLIMIT_FSIZE, &old_limit);
  sigaction(SIGXFSZ, &old_action, nullptr);
  CHECK_FALSE(saved);
  CHECK(error.find("No space left on device") != std::string::npos);
  CHECK(error.find("C.ST.retained.1") != std::string::npos);
  CHECK(loaded.record->slots == slots_of(1));
  CHECK(store.save(1, slots_of(3)));
  CHECK(load(directory).record->slots == slots_of(3));
}

TEST_CASE("file that is deleted while the store is open is made anew [IMG-4]") {
  const Directory directory;
  RetainStore store(directory.path, "C", "ST", kLayout);
  for (Slot n = 1; n <= 2; ++n) REQUIRE(store.save(1, slots_of(n)));
  fs::remove(directory.file(0));
  fs::remove(directory.file(1));
  CHECK(store.save(1, slots_of(3)));
  CHECK(load(directory).record->slots == slots_of(3));
}

TEST_CASE("directory in a file's place is kept aside [IMG-4]") {
  const Directory directory;
  fs::create_directory(directory.file(0));
  const auto loaded = load(directory);
  CHECK_FALSE(loaded.record.has_value());
  CHECK(fs::is_directory(directory.aside(0)));
}

TEST_CASE("state directory is made with its parents") {
  const Directory directory;
  const RetainStore store(directory.path / "a" / "b", "C", "ST", kLayout);
  CHECK(fs::is_directory(directory.path / "a" / "b"));
}

TEST_CASE("state directory that cannot be made is refused with what to do") {
  const Directory directory;
  put(directory.path / "file", "x");
  CHECK_THROWS_WITH_AS(RetainStore(directory.path / "file", "C", "ST", kLayout),
                       doctest::Contains("cannot be written"), SetupError);
  CHECK_THROWS_WITH_AS(RetainStore(directory.path / "file" / "below", "C", "ST", kLayout),
                       doctest::Contains("Not a directory; set [controller] state_dir"), SetupError);
}

TEST_CASE("state directory that this user may not write is refused with what to do") {
  if (geteuid() == 0) {
    MESSAGE("root may write anywhere: /proc stands for a directory that nobody may");
    CHECK_THROWS_WITH_AS(RetainStore("/proc/stationd", "C", "ST", kLayout),
                         doctest::Contains("cannot be written"), SetupError);
    return;
  }
  const Directory directory;
  fs::permissions(directory.path, fs::perms::owner_read | fs::perms::owner_exec);
  CHECK_THROWS_WITH_AS(RetainStore(directory.path, "C", "ST", kLayout),
                       doctest::Contains("Permission denied"), SetupError);
}

TEST_CASE("layout hash tells names, types, lengths and order apart [IMG-4]") {
  const auto hash = [](std::string first, TagType type, std::uint16_t length, std::vector<TagIndex> order) {
    Image image;
    TagSpec a;
    a.name = std::move(first);
    a.type = type;
    a.length = length;
    TagSpec b;
    b.name = "b";
    image.add(a);
    image.add(b);
    return layout_hash(image, order);
  };
  const std::uint64_t base = hash("a", TagType::STRING, 8, {0, 1});
  CHECK(base == hash("a", TagType::STRING, 8, {0, 1}));
  CHECK(base != hash("c", TagType::STRING, 8, {0, 1}));
  CHECK(base != hash("a", TagType::INT, 8, {0, 1}));
  CHECK(base != hash("a", TagType::STRING, 9, {0, 1}));
  CHECK(base != hash("a", TagType::STRING, 8, {1, 0}));
  CHECK(base != hash("a", TagType::STRING, 8, {0}));
}

}  // namespace
}  // namespace stationd
