#include "manipulators/render/bindings.h"

#include <gtest/gtest.h>

namespace render {
namespace {

TEST(Bindings, KnowWhatCanHappen) {
  for (const char* good : {"Key-space", "Shift-Key-r", "Control-Shift-Key-F1", "Button1", "Button3-drag", "Alt-Button2",
                           "Wheel-up", "Control-Wheel-down"}) {
    EXPECT_EQ(Bindings::event_problem(good), "") << good;
  }
  for (const char* bad : {"", "space", "Key-", "Button4", "Button1-drop", "Wheel", "Hyper-Key-x"}) {
    EXPECT_NE(Bindings::event_problem(bad), "") << bad;
  }
}

TEST(Bindings, FillInTheObjectAndThePlace) {
  Bindings bindings;
  bindings.bind("Button1-drag", "set %path.position %x %y %z");
  bindings.bind("Key-space", "pause");
  bindings.bind("Key-p", "echo 100%% of %event");
  Gesture drag{"Button1-drag", "ball", true, {0.30000001192, -1.25, 2}};
  EXPECT_EQ(bindings.command(drag), "set ball.position 0.3 -1.25 2");
  EXPECT_EQ(bindings.command({"Key-space", "", false, {0, 0, 0}}), "pause");
  EXPECT_EQ(bindings.command({"Key-p", "", false, {0, 0, 0}}), "echo 100% of Key-p");
}

TEST(Bindings, SayNothingWithoutWhatTheyAskFor) {
  Bindings bindings;
  bindings.bind("Button1", "set %path.visible false");
  bindings.bind("Button2", "set ball.position %x %y %z");
  EXPECT_EQ(bindings.command({"Button1", "", true, {1, 2, 3}}), "");
  EXPECT_EQ(bindings.command({"Button2", "ball", false, {1, 2, 3}}), "");
  EXPECT_EQ(bindings.command({"Button3", "ball", true, {1, 2, 3}}), "");
  EXPECT_TRUE(bindings.unbind("Button1"));
  EXPECT_FALSE(bindings.unbind("Button1"));
}

}  // namespace
}  // namespace render
