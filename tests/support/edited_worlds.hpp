#pragma once

#include <gtest/gtest.h>

#include <functional>
#include <string>

#include "plumb/plumb.hpp"
#include "support/refusals.hpp"

/// What tests of edits share.
namespace plumb::test {

/// Calls f(settings) for all ways to move rods that may be edited.
template <class F>
void for_methods(F&& f) {
  for (const Method method : {Method::automatic, Method::direct, Method::relax})
    for (const Precision precision : {Precision::double_, Precision::single})
      for (const Gradient gradient : {Gradient::mid, Gradient::old, Gradient::new_}) {
        SCOPED_TRACE(std::string(to_string(method)) + ' ' + std::string(to_string(precision)) + ' ' +
                     std::string(to_string(gradient)));
        Settings settings{
            .method = method, .precision = precision, .gradient = gradient, .substeps = 4, .threads = 1};
        if (method == Method::relax) settings.stop.sweeps = 100;
        f(settings);
      }
}

inline void expect_refusal(const std::string& reason, const std::function<void()>& edit) {
  EXPECT_NE(refusal(edit).find(reason), std::string::npos) << refusal(edit);
}

}  // namespace plumb::test
