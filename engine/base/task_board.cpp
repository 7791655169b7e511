#include "engine/base/task_board.h"

#include <algorithm>
#include <condition_variable>
#include <deque>
#include <exception>
#include <functional>
#include <map>
#include <mutex>
#include <new>
#include <utility>

#include <tbb/task_arena.h>

namespace geosis {

struct TaskBoard::State {
  explicit State(int most_helpers) : helpers(most_helpers) {}

  using Task = std::function<void()>;

  const int helpers;
  std::mutex mutex;
  std::condition_variable changed;
  std::multimap<int, Task, std::greater<>> waiting;  // by urgency, in order of adding
  int called = 0;                                    // helpers that have come or will
  int running = 0;
  std::uint64_t ended = 0;
  bool closed = false;
  std::exception_ptr thrown;

  Task take_first() {
    Task task = std::move(waiting.begin()->second);
    waiting.erase(waiting.begin());
    ++running;
    return task;
  }

  /// Runs a task that was taken, and lets go of it before its end is told.
  void run(Task task) {
    std::exception_ptr problem;
    try {
      task();
    } catch (...) {
      problem = std::current_exception();
    }
    task = nullptr;
    const std::lock_guard lock(mutex);
    --running;
    ++ended;
    if (problem && !thrown) thrown = problem;
    changed.notify_all();
  }
};

/// Where all boards of the process call for help. The arena's priority is low: workers come when no parallel_for needs
/// them, and take the oldest call. Nothing of a board stays behind here when it is gone.
class TaskBoard::SpareThreads {
 public:
  /// Never destroyed: workers may come when the process already ends.
  static SpareThreads& of_process() {
    static auto& threads = *new SpareThreads;
    return threads;
  }

  void call(const std::shared_ptr<State>& state) {
    {
      const std::lock_guard lock(mutex_);
      calls_.push_back(state);
    }
    try {
      arena_.enqueue([] { of_process().answer(); });
    } catch (const std::bad_alloc&) {
      const std::lock_guard lock(mutex_);
      const auto unanswered = std::ranges::find(calls_, state);
      if (unanswered == calls_.end()) return;
      calls_.erase(unanswered);
      throw;
    }
  }

  void forget_calls(const std::shared_ptr<State>& state) {
    const std::lock_guard lock(mutex_);
    std::erase(calls_, state);
  }

 private:
  void answer() {
    std::shared_ptr<State> state;
    {
      const std::lock_guard lock(mutex_);
      if (calls_.empty()) return;
      state = std::move(calls_.front());
      calls_.pop_front();
    }
    help(state);
  }

  std::mutex mutex_;
  std::deque<std::shared_ptr<State>> calls_;
  tbb::task_arena arena_{tbb::task_arena::automatic, 1, tbb::task_arena::priority::low};
};

TaskBoard::TaskBoard(int helpers) : state_(std::make_shared<State>(helpers)) {}

TaskBoard::~TaskBoard() {
  std::multimap<int, State::Task, std::greater<>> forgotten;
  std::unique_lock lock(state_->mutex);
  state_->closed = true;
  forgotten.swap(state_->waiting);
  state_->changed.wait(lock, [&] { return state_->running == 0; });
  lock.unlock();
  SpareThreads::of_process().forget_calls(state_);
}

void TaskBoard::add(int urgency, std::function<void()> task) {
  {
    const std::lock_guard lock(state_->mutex);
    if (state_->closed) return;
    state_->waiting.emplace(urgency, std::move(task));
    state_->changed.notify_all();
    if (state_->called == state_->helpers) return;
    ++state_->called;
  }
  call_helper(state_);
}

void TaskBoard::work_until(int least_urgency, const std::function<bool()>& done) {
  std::uint64_t seen = 0;
  const auto may_take = [&] {
    return !state_->waiting.empty() && state_->waiting.begin()->first >= least_urgency && !state_->thrown;
  };
  for (;;) {
    {
      const std::lock_guard lock(state_->mutex);
      if (state_->thrown) std::rethrow_exception(state_->thrown);
      seen = state_->ended;
    }
    if (done()) return;
    std::unique_lock lock(state_->mutex);
    const bool all_ended = state_->running == 0 && state_->ended == seen;
    if (all_ended && !may_take()) return;
    state_->changed.wait(lock, [&] { return may_take() || state_->ended != seen; });
    if (!may_take()) continue;
    State::Task task = state_->take_first();
    lock.unlock();
    state_->run(std::move(task));
  }
}

void TaskBoard::call_helper(const std::shared_ptr<State>& state) {
  try {
    SpareThreads::of_process().call(state);
  } catch (const std::bad_alloc&) {  // then there is a helper less
    const std::lock_guard lock(state->mutex);
    --state->called;
  }
}

/// One task, then the thread is free again: it comes back when nothing else wants it.
void TaskBoard::help(const std::shared_ptr<State>& state) {
  State::Task task;
  {
    const std::lock_guard lock(state->mutex);
    if (state->waiting.empty() || state->thrown) {
      --state->called;
      return;
    }
    task = state->take_first();
  }
  state->run(std::move(task));
  call_helper(state);
}

}  // namespace geosis
