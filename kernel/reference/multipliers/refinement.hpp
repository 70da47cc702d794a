#pragma once

#include <Eigen/Core>
#include <utility>

namespace plumb::detail {

/// Takes out of a solution x, lambda what a matrix that is softened, so that it is definite, leaves (the
/// proximal point method).
class Refinement {
 public:
  /// Returns what is left in the end. residuals() says what is left now, and correct() adds a solution for
  /// that. It stops at `enough`, where a round does not halve what is left, or after twenty.
  template <class Residuals, class Correct>
  double run(Eigen::VectorXd& x, Eigen::VectorXd& lambda, double enough, Residuals&& residuals,
             Correct&& correct) {
    double left = residuals();
    for (int round = 0; round < 20 && left > enough; ++round) {
      better_x_ = x;
      better_lambda_ = lambda;
      correct();
      const double now = residuals();
      if (!(now < left)) {
        std::swap(x, better_x_);
        std::swap(lambda, better_lambda_);
        break;
      }
      const bool stalls = now > 0.5 * left;
      left = now;
      if (stalls) break;
    }
    return left;
  }

 private:
  Eigen::VectorXd better_x_, better_lambda_;
};

}  // namespace plumb::detail
