// The input sources of the virtual device: what a person moves a handle with that no haptic device senses.
// The source that was used last leads the hand; the others wait.
#pragma once

#include <memory>
#include <utility>

#include "haptic/devices/steered_device.h"
#include "haptic/hand.h"

namespace spoonbill {

// A mouse, a SpaceMouse. One owner: the thread that draws.
class InputSource {
 public:
  virtual ~InputSource() = default;

  // Whether the person uses the source in this frame. Called once a frame, first.
  virtual bool is_used() = 0;

  // Where the person wants the handle, given where it was wanted `elapsed_s` ago. Only while the source
  // leads.
  virtual HandTarget next_target(const HandTarget& current, double elapsed_s) = 0;
};

// One owner: the thread that draws.
class HandInputs {
 public:
  // `leader` leads until another source is used. Sources must live as long as they may be updated.
  HandInputs(std::shared_ptr<TargetMailbox> mailbox, const HandTarget& start, const InputSource& leader)
      : mailbox_(std::move(mailbox)), target_(start), leader_(&leader) {}

  // Sends the source's target to the device where the source leads, or takes the lead by being used.
  void update(InputSource& source, double elapsed_s) {
    if (source.is_used()) leader_ = &source;
    if (leader_ != &source) return;
    target_ = source.next_target(target_, elapsed_s);
    mailbox_->aim(target_);
  }

 private:
  std::shared_ptr<TargetMailbox> mailbox_;
  HandTarget target_;
  const InputSource* leader_;
};

}  // namespace spoonbill
