# Reads this export with R and draws the scores of each condition: Rscript analysis.R, in the folder of the export.

files <- list.files("data", pattern = "_description-scores_data.csv$", full.names = TRUE)
scores <- read.csv(files[1], check.names = FALSE, na.strings = "", stringsAsFactors = FALSE)
scores <- scores[scores$run_counts == "true", ]
factors <- names(scores)[seq_len(which(names(scores) == "step") - 1)][-(1:2)]
for (subscale in unique(scores$subscale)) {
  rows <- scores[scores$subscale == subscale & !is.na(scores$score), ]
  by <- Filter(function(name) !any(is.na(rows[[name]])), factors)
  group <- if (length(by) > 0) do.call(paste, rows[by]) else rep(subscale, nrow(rows))
  means <- tapply(rows$score, group, mean)
  errors <- tapply(rows$score, group, function(x) sd(x) / sqrt(length(x)))
  cat("\n", subscale, "\n", sep = "")
  print(data.frame(n = as.vector(table(group)), mean = round(as.vector(means), 2), sem = round(as.vector(errors), 2),
                   row.names = names(means)))
  png(paste0(subscale, "-r.png"), width = 600, height = 450)
  places <- barplot(means, ylab = paste(subscale, "(mean, 95 %)"), ylim = c(0, 1.25 * max(means)))
  known <- !is.na(errors) & errors > 0
  if (any(known)) {
    arrows(places[known], (means - 1.96 * errors)[known], places[known], (means + 1.96 * errors)[known],
           angle = 90, code = 3, length = 0.05)
  }
  invisible(dev.off())
}
