#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace mallow::program {

/// The folder beside the frames in which programs that share them tell each other who does what.
inline constexpr const char* k_share_folder = ".mallow-share";

/// An open file that this process alone has locked. The system frees it when the process ends, however that
/// comes, so there is no stale one.
class FileLock {
 public:
  /// Null where another process has it. Throws IoError where it cannot be had at all, as on a disk without
  /// locks.
  static std::unique_ptr<FileLock> try_lock(const std::filesystem::path& file);
  /// Waits for it. Throws Interrupted at Ctrl-C.
  static std::unique_ptr<FileLock> wait_for(const std::filesystem::path& file);
  ~FileLock();
  FileLock(const FileLock&) = delete;
  FileLock& operator=(const FileLock&) = delete;

  /// What the file is to hold.
  void write(const std::string& text) const;
  /// Of the open file. A program that gets it keeps the lock too, until both have ended.
  int descriptor() const { return descriptor_; }

 private:
  FileLock(std::filesystem::path file, int descriptor) : file_(std::move(file)), descriptor_(descriptor) {}

  std::filesystem::path file_;
  int descriptor_;
};

/// Keeps what `folder`/.mallow-share/lock guards to oneself: files that the programs which share a folder
/// read at their start and write at the end. Waits for it.
std::unique_ptr<FileLock> lock_shared_folder(const std::filesystem::path& folder);

/// Forgets what frames of `folder` were done by programs that share them; removes their files and no others.
/// For those who have the folder to themselves.
void forget_shared_frames(const std::filesystem::path& folder);

/// Frames that several processes work on at a time, on one machine or on several with one disk. Who works on
/// a frame has locked its file in the share folder; who is done notes there by what and into what. So no two
/// write one frame, what a killed process had not done is done by another, and nothing is done twice.
class SharedFrames {
 public:
  struct Files {
    std::vector<std::filesystem::path> read, written;
  };
  /// A frame that this process works on, until it is let go.
  class Claim {
   public:
    Claim(const SharedFrames& frames, int frame, std::unique_ptr<FileLock> lock)
        : frames_(frames), frame_(frame), lock_(std::move(lock)) {}
    /// Its files are there, as the job wants them.
    void done() const;

   private:
    const SharedFrames& frames_;
    int frame_;
    std::unique_ptr<FileLock> lock_;
  };

  /// folder: that which is shared. command: whose frames. job: all that says what the frames are to be, so
  /// that those of another job do not count as done.
  SharedFrames(const std::filesystem::path& folder, const std::string& command, const std::string& job,
               std::function<Files(int frame)> files);

  /// Null where another process works on it.
  std::shared_ptr<const Claim> try_claim(int frame) const;
  /// Notes that a frame's files are there, as Claim::done() does: for who has the folder alone, which needs
  /// no lock. Where the note cannot be written, the frame counts as left.
  void note(int frame) const;
  /// By this job, from the files that are there now, which nobody has changed since.
  bool is_done(int frame) const;
  /// Those of them that are not.
  std::vector<int> left(const std::vector<int>& frames) const;
  /// How many.
  std::size_t count_left(const std::vector<int>& frames) const;
  /// Once all of `frames` are done, one process calls `join`, which makes `made` of them; others wait until
  /// that is there. Returns how many frames are left, for others to do.
  std::size_t join(const std::vector<int>& frames, const std::vector<std::filesystem::path>& made,
                   const std::function<void()>& join) const;

 private:
  std::filesystem::path file_of(int frame) const;
  std::string note_of(int frame) const;

  std::filesystem::path folder_;  ///< that is shared
  std::filesystem::path notes_;
  std::uint64_t job_;
  std::function<Files(int)> files_;
};

}  // namespace mallow::program
