#pragma once

#include <string>

namespace plumb::bench {

/// Returns how many times the work of one thread two do together in the same time. It is close to 2 on a
/// machine that does nothing else, and close to 1 where somebody else holds a processor. It is 1 on a machine
/// with one processor.
double work_of_two_threads();

/// Says in a sentence how quiet the machine was, by work_of_two_threads() when a run began and now. Warns on
/// stderr if that is too little to believe times of two threads.
std::string quiet_text(double at_the_beginning);

}  // namespace plumb::bench
