#include "app/report/progress_page.h"

#include <algorithm>
#include <set>
#include <vector>

#include "app/report/quantity_text.h"
#include "app/study/page_parts.h"

namespace spoonbill {
namespace {

using AttemptList = std::vector<const Attempt*>;

std::string px_text(double value) {
  return decimals_text(value, 1);
}

std::string attempt_title(const Attempt& attempt) {
  const std::string hand = attempt.hand.empty() ? "hand not modelled" : attempt.hand;
  return html(attempt.date + ", " + attempt.spoon + ", " + hand + ", guidance " +
              percent_text(attempt.guidance) + ": " + decimals_text(attempt.score, 0));
}

// Draws the scores of a task: a dot for a success, a cross for a failure, which scores 0.
std::string score_chart(const AttemptList& attempts) {
  constexpr double left = 44.0, right = 780.0, top = 12.0, bottom = 190.0, mark = 4.0;
  const auto x = [&](std::size_t k) {
    const double count = std::max(1.0, static_cast<double>(attempts.size()) - 1.0);
    return left + 16.0 + (right - left - 32.0) * static_cast<double>(k) / count;
  };
  const auto y = [&](double score) { return bottom - (bottom - top) * score / 100.0; };
  std::string text =
      "<div class=scroll><svg viewBox=\"0 0 800 220\" role=img aria-label=\"Score by attempt\">";
  for (const double score : {0.0, 25.0, 50.0, 75.0, 100.0}) {
    text +=
        "<path class=grid d=\"M" + px_text(left) + " " + px_text(y(score)) + "H" + px_text(right) + "\"/>";
    text += "<text class=at-end x=" + px_text(left - 6.0) + " y=" + px_text(y(score) + 4.0) + ">" +
            decimals_text(score, 0) + "</text>";
  }
  text += "<text class=centred x=" + px_text(0.5 * (left + right)) + " y=214>attempt 1 to " +
          std::to_string(attempts.size()) + "</text>";
  std::string line;
  for (std::size_t k = 0; k < attempts.size(); ++k) {
    line += (k == 0 ? "M" : "L") + px_text(x(k)) + " " + px_text(y(attempts[k]->score));
  }
  text += "<path class=axis d=\"" + line + "\"/>";
  for (std::size_t k = 0; k < attempts.size(); ++k) {
    const Attempt& attempt = *attempts[k];
    const double at_x = x(k), at_y = y(attempt.score);
    const std::string title = "<title>" + attempt_title(attempt) + "</title>";
    if (attempt.end == TaskEnd::success) {
      text += "<circle class=first cx=" + px_text(at_x) + " cy=" + px_text(at_y) + " r=" + px_text(mark) +
              ">" + title + "</circle>";
      continue;
    }
    const std::string from = px_text(at_x - mark) + " ", to = px_text(at_x + mark) + " ";
    text += "<path stroke=\"#b8432f\" stroke-width=2 d=\"M" + from + px_text(at_y - mark) + "L" + to +
            px_text(at_y + mark) + "M" + from + px_text(at_y + mark) + "L" + to + px_text(at_y - mark) +
            "\">" + title + "</path>";
  }
  return text + "</svg></div>\n";
}

std::string task_part(const std::string& task, const AttemptList& attempts) {
  const auto successes = std::count_if(attempts.begin(), attempts.end(), [](const Attempt* attempt) {
    return attempt->end == TaskEnd::success;
  });
  return "<section><h2>" + html(task) + "</h2>\n<p>" + std::to_string(attempts.size()) + " attempts, " +
         std::to_string(successes) + " successes. A dot is a success, a cross a failure.</p>\n" +
         score_chart(attempts) + "</section>\n";
}

std::string attempts_part(const std::vector<Attempt>& attempts) {
  PageTable table("attempts",
                  {"date", "task", "spoon", "hand", "guidance", "end", "score", "time, s", "lost, %",
                   "path, mm", "smoothness", "tremor, mm", "wrist used, %", "grip used, %", "force, N"});
  for (const Attempt& attempt : attempts) {
    table.row().text(attempt.date).text(attempt.task).text(attempt.spoon);
    table.text(name_of_hand(attempt.hand)).number(100.0 * attempt.guidance, 0);
    table.text(task_end_names[static_cast<std::size_t>(attempt.end)]).number(attempt.score, 0);
    table.number(attempt.time_s, 1).number(100.0 * attempt.food_lost_fraction, 1);
    table.number(1e3 * attempt.path_m, 0).number(attempt.smoothness, 2).number(1e3 * attempt.tremor_m, 2);
    table.number(100.0 * attempt.wrist_used, 0).number(100.0 * attempt.grip_used, 0);
    table.number(attempt.largest_force_n, 2);
  }
  return section("all", "All attempts") + table.finish() + "</section>\n";
}

}  // namespace

Result<std::string> make_progress_page(const std::string& person, const LoggedAttempts& logged) {
  std::set<std::string> tasks;
  for (const Attempt& attempt : logged.attempts) tasks.insert(attempt.task);
  std::string body;
  if (logged.unreadable_lines > 0) {
    body += "<p class=note>" + std::to_string(logged.unreadable_lines) +
            " lines of the log are cut or changed and are left out.</p>\n";
  }
  for (const std::string& task : tasks) {
    AttemptList attempts;
    for (const Attempt& attempt : logged.attempts) {
      if (attempt.task == task) attempts.push_back(&attempt);
    }
    body += task_part(task, attempts);
  }
  return make_page("Progress of " + person, "Progress of " + person, body + attempts_part(logged.attempts));
}

}  // namespace spoonbill
