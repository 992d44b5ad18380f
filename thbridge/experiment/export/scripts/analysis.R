# Compares the conditions of this export and draws them: Rscript analysis.R (needs only base R).
#
# Writes results/cells-r.csv (mean of each condition with a 95 % interval), results/tests-r.csv and a figure of each
# outcome. Within people: paired t tests on complete people, with d = mean difference / its standard deviation, and the F
# of aov(value ~ factor + Error(participant / factor)) for more than two levels. Between people: Welch's t tests on
# people's means, with d by the pooled standard deviation. Interactions: Welch's t tests on differences within people.
# p_holm is adjusted for all pairs of levels of one factor. analysis.py does the same in Python.

here <- dirname(sub("^--file=", "", grep("^--file=", commandArgs(FALSE), value = TRUE)[1]))
outcomes_of <- list(
  trials = c("score", "rooms_visited"), reliance = "appropriate", fluency = c("human_idle", "concurrent_activity")
) # columns that the script compares in addition to all scores of forms; add your own columns

# Removes the apostrophe that the export writes before texts that look like formulas of a spreadsheet.
plain <- function(column) if (is.character(column)) sub("^'('*[=+@\t\r-])", "\\1", column) else column
plain_texts <- function(read) { read[] <- lapply(read, plain); read }

dictionary <- plain_texts(read.csv(file.path(here, "dictionary.csv"), colClasses = "character"))

# Returns the valid rows of a table. Columns have their types: factors, numbers, booleans, times.
read_table <- function(name) {
  word <- if (grepl("_", name)) gsub(" ", "", tools::toTitleCase(gsub("_", " ", name))) else name
  file <- list.files(file.path(here, "data"), paste0("_description-", word, "_data.csv$"), full.names = TRUE)
  columns <- dictionary[dictionary$table == name, ]
  classes <- c(string = "character", time = "character", float64 = "numeric", int64 = "numeric", bool = "logical")
  read <- read.csv(file, check.names = FALSE, na.strings = "", colClasses = unname(classes[columns$type]))
  read <- plain_texts(read)
  for (i in seq_len(nrow(columns))) {
    column <- columns$column[i]
    if (columns$factor[i] != "") {
      read[[column]] <- factor(read[[column]], strsplit(columns$levels[i], "; ", fixed = TRUE)[[1]])
    } else if (columns$type[i] == "time") {
      read[[column]] <- as.POSIXct(read[[column]], "UTC", tryFormats = c("%Y-%m-%dT%H:%M:%OSZ", "%Y-%m-%dT%H:%M:%OS"))
    }
  }
  read[read$counts, ]
}

factors <- function(name, role) {
  rows <- dictionary[dictionary$table == name & dictionary$factor == role, ]
  rows$column[grepl("; ", rows$levels, fixed = TRUE)]
}

all_outcomes <- function() {
  found <- list()
  if ("scores" %in% dictionary$table) {
    scores <- read_table("scores")
    for (subscale in sort(unique(scores$subscale))) {
      rows <- scores[scores$subscale == subscale, ]
      rows$value <- rows$score
      found[[subscale]] <- list(table = "scores", rows = rows[!is.na(rows$value), ])
    }
  }
  for (name in intersect(names(outcomes_of), dictionary$table)) {
    rows <- read_table(name)
    for (column in outcomes_of[[name]]) {
      rows$value <- as.numeric(rows[[column]])
      found[[paste0(name, ".", column)]] <- list(table = name, rows = rows[!is.na(rows$value), ])
    }
  }
  found
}

# Returns the rows of people with a value in each condition, one row for each person and condition.
complete_rows <- function(rows, within, between) {
  by <- rows[c("participant", rev(within), rev(between))]
  means <- aggregate(list(value = rows$value), by, mean)
  wanted <- prod(vapply(within, function(factor) nlevels(rows[[factor]]), 1L))
  means <- means[ave(means$value, means$participant, FUN = length) == wanted, c("participant", between, within, "value")]
  means[do.call(order, unname(means[c(between, within, "participant")])), ]
}

cell_names <- function(rows, levels) {
  if (length(levels) == 0) rep("", nrow(rows)) else do.call(paste, c(unname(lapply(rows[levels], as.character)), sep = "; "))
}

# Returns the mean and 95 % interval of each condition. Intervals within people exclude differences between people
# (Cousineau and Morey).
cells <- function(name, rows, within, between) {
  conditions <- max(table(rows$participant))
  spread <- rows$value
  if (conditions > 1) {
    spread <- rows$value - ave(rows$value, rows$participant) + ave(rows$value, cell_names(rows, between))
  }
  names <- cell_names(rows, c(between, within))
  do.call(rbind, lapply(unique(names), function(cell) {
    own <- names == cell
    n <- sum(own)
    deviation <- sd(spread[own]) * sqrt(if (conditions > 1) conditions / (conditions - 1) else 1)
    half <- if (n > 1) qt(0.975, n - 1) * deviation / sqrt(n) else NA
    mean <- mean(rows$value[own])
    data.frame(
      outcome = name, cell = cell, n = n, mean = mean, sd = sd(rows$value[own]), low = mean - half, high = mean + half
    )
  }))
}

line <- function(name, test, comparison, n, estimate = NA, low = NA, high = NA, statistic, df, df2 = NA, p, effect = NA) {
  data.frame(
    outcome = name, test = test, comparison = comparison, n = n, estimate = estimate, low = low, high = high,
    statistic = statistic, df = df, df2 = df2, p = p, effect_size = effect, p_holm = NA
  )
}

paired <- function(name, comparison, difference) {
  deviation <- sd(difference)
  if (!isTRUE(deviation > 0)) {
    mean <- mean(difference)
    return(line(name, "paired t", comparison, length(difference), mean, mean, mean, NA, length(difference) - 1, p = NA))
  }
  tested <- t.test(difference)
  line(
    name, "paired t", comparison, length(difference), mean(difference), tested$conf.int[1], tested$conf.int[2],
    tested$statistic, tested$parameter, p = tested$p.value, effect = mean(difference) / deviation
  )
}

welch <- function(name, test, comparison, one, other) {
  tested <- t.test(other, one)
  n <- length(one) + length(other)
  pooled <- sqrt(((length(one) - 1) * var(one) + (length(other) - 1) * var(other)) / (n - 2))
  estimate <- mean(other) - mean(one)
  line(
    name, test, comparison, n, estimate, tested$conf.int[1], tested$conf.int[2], tested$statistic, tested$parameter,
    p = tested$p.value, effect = estimate / pooled
  )
}

pairs_of <- function(levels) if (length(levels) > 1) combn(levels, 2, simplify = FALSE) else list()

holm <- function(tests) {
  if (length(tests) == 0) return(NULL)
  tests <- do.call(rbind, tests)
  tests$p_holm <- p.adjust(tests$p, "holm")
  tests
}

within_tests <- function(name, rows, factor) {
  own <- aggregate(list(value = rows$value), list(participant = rows$participant, level = rows[[factor]]), mean)
  own$participant <- factor(own$participant)
  values <- lapply(split(own, own$level), function(of) of$value[order(of$participant)])
  tests <- holm(lapply(pairs_of(levels(own$level)), function(pair) {
    paired(name, sprintf("%s: %s - %s", factor, pair[2], pair[1]), values[[pair[2]]] - values[[pair[1]]])
  }))
  if (nlevels(own$level) > 2) {
    f <- summary(aov(value ~ level + Error(participant / level), own))[["Error: participant:level"]][[1]]
    whole <- line(
      name, "F within", factor, nlevels(own$participant), statistic = f[1, "F value"], df = f[1, "Df"], df2 = f[2, "Df"],
      p = f[1, "Pr(>F)"]
    )
    tests <- rbind(whole, tests)
  }
  tests
}

between_tests <- function(name, rows, factor) {
  own <- aggregate(list(value = rows$value), list(participant = rows$participant, level = rows[[factor]]), mean)
  groups <- Filter(function(values) length(values) > 1, split(own$value, own$level))
  tests <- holm(lapply(pairs_of(names(groups)), function(pair) {
    comparison <- sprintf("%s: %s - %s", factor, pair[2], pair[1])
    welch(name, "Welch t", comparison, groups[[pair[1]]], groups[[pair[2]]])
  }))
  if (length(groups) > 2) {
    f <- summary(aov(value ~ level, own[own$level %in% names(groups), ]))[[1]]
    whole <- line(
      name, "F between", factor, sum(lengths(groups)), statistic = f[1, "F value"], df = f[1, "Df"], df2 = f[2, "Df"],
      p = f[1, "Pr(>F)"]
    )
    tests <- rbind(whole, tests)
  }
  tests
}

interactions <- function(name, rows, inside, outside) {
  by <- list(participant = rows$participant, level = rows[[inside]], group = rows[[outside]])
  own <- aggregate(list(value = rows$value), by, mean)
  tests <- list()
  for (pair in pairs_of(levels(own$level))) {
    wide <- merge(own[own$level == pair[1], ], own[own$level == pair[2], ], by = c("participant", "group"))
    groups <- Filter(function(values) length(values) > 1, split(wide$value.y - wide$value.x, wide$group))
    for (groups_pair in pairs_of(names(groups))) {
      comparison <- sprintf(
        "(%s: %s - %s) x (%s: %s - %s)", inside, pair[2], pair[1], outside, groups_pair[2], groups_pair[1]
      )
      tested <- welch(name, "interaction t", comparison, groups[[groups_pair[1]]], groups[[groups_pair[2]]])
      tests <- c(tests, list(tested))
    }
  }
  holm(tests)
}

draw <- function(name, rows, levels, told) {
  png(file.path(here, "results", paste0(name, "-r.png")), width = 270 + 180 * nrow(told), height = 510)
  at <- match(cell_names(rows, levels), told$cell)
  plot(
    at, rows$value, xlim = c(0.5, nrow(told) + 0.5), xaxt = "n", xlab = "", ylab = paste(name, "(mean, 95 %)"),
    col = "grey80", pch = 20
  )
  for (person in unique(rows$participant)) {
    own <- which(rows$participant == person)
    own <- own[order(at[own])]
    lines(at[own], rows$value[own], col = "grey80")
  }
  axis(1, seq_len(nrow(told)), ifelse(told$cell == "", "all", told$cell))
  known <- which(told$high > told$low)
  if (length(known) > 0) arrows(known, told$low[known], known, told$high[known], angle = 90, code = 3, length = 0.05)
  points(seq_len(nrow(told)), told$mean, pch = 19)
  invisible(dev.off())
}

dir.create(file.path(here, "results"), showWarnings = FALSE)
options(width = 200)
means <- NULL
tests <- NULL
found <- all_outcomes()
for (name in names(found)) {
  values <- found[[name]]$rows
  within <- Filter(function(factor) !anyNA(values[[factor]]), factors(found[[name]]$table, "within"))
  between <- factors(found[[name]]$table, "between")
  if (nrow(values) == 0) next
  rows <- complete_rows(values, within, between)
  if (nrow(rows) == 0) next
  told <- cells(name, rows, within, between)
  draw(name, rows, c(between, within), told)
  means <- rbind(means, told)
  if (length(unique(rows$value)) < 2) next # All values are equal, so a comparison is not possible.
  for (factor in within) tests <- rbind(tests, within_tests(name, rows, factor))
  for (factor in between) tests <- rbind(tests, between_tests(name, rows, factor))
  for (inside in within) for (outside in between) tests <- rbind(tests, interactions(name, rows, inside, outside))
}
for (file in c("cells", "tests")) {
  lines <- if (file == "cells") means else tests
  path <- file.path(here, "results", paste0(file, "-r.csv"))
  if (is.null(lines)) {
    unlink(path)
    cat("\n", file, ": none, because no participant has data in all conditions, or all values are equal.\n", sep = "")
    next
  }
  numbers <- vapply(lines, is.numeric, TRUE)
  rounded <- lines
  rounded[numbers] <- lapply(lines[numbers], signif, 6)
  write.csv(rounded, path, row.names = FALSE, na = "")
  rounded[numbers] <- lapply(lines[numbers], round, 4)
  cat("\n", file, "\n", sep = "")
  print(rounded, row.names = FALSE)
}
