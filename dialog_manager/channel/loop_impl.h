#pragma once

#include <boost/asio/io_context.hpp>
#include <boost/asio/posix/stream_descriptor.hpp>
#include <boost/asio/signal_set.hpp>
#include <boost/asio/steady_timer.hpp>

#include "dialog_manager/channel/loop.h"

namespace channel {

struct Loop::Impl {
  boost::asio::io_context context{1};
  boost::asio::signal_set signals{context};
};

}  // namespace channel
