#pragma once

#include <cstdint>
#include <functional>
#include <memory>

namespace geosis {

/// Tasks that are worked off by the thread that needs their results and, beside it, by threads that the process has to
/// spare: workers that no parallel_for wants at the moment. A spare thread goes back to parallel_for after each task.
///
/// Of the tasks that wait, the most urgent begins first; of equally urgent ones the oldest. Tasks write to their own
/// places and may add tasks. What a task writes is seen by tasks that it adds and, once `done` says so, by the waiting
/// thread.
class TaskBoard {
 public:
  /// helpers   tasks that spare threads run at a time; 0 = none: every task is run by work_until, in order.
  explicit TaskBoard(int helpers);
  /// Forgets tasks that have not begun and waits for those that have.
  ~TaskBoard();
  TaskBoard(const TaskBoard&) = delete;
  TaskBoard& operator=(const TaskBoard&) = delete;

  /// From any thread, tasks included.
  void add(int urgency, std::function<void()> task);

  /// Runs tasks of at least that urgency on this thread, and waits when there are none, until done() holds or no task
  /// is left. done() is asked on this thread, before the first task and after every one of any thread. Throws what a
  /// task has thrown.
  void work_until(int least_urgency, const std::function<bool()>& done);

 private:
  struct State;
  class SpareThreads;
  static void call_helper(const std::shared_ptr<State>& state);
  static void help(const std::shared_ptr<State>& state);

  std::shared_ptr<State> state_;  // helpers that find nothing to do may let go of it after the board is gone
};

}  // namespace geosis
