// Shows a sentence when the page cannot go on, and reports the cause to the server once. It runs before the page's
// modules, because both are deferred, and its syntax is so old that browsers that are too old for the page run it too.
(function () {
  var told = false;

  function show(id) {
    var box = document.getElementById("trouble");
    if (!box) return;
    var parts = box.children;
    for (var at = 0; at < parts.length; at++) parts[at].hidden = parts[at].id !== id;
    box.hidden = false;
    hide("too-old");
    if (id === "old") hide("main");
  }

  function hide(id) {
    var part = document.getElementById(id);
    if (part) part.hidden = true;
  }

  function report(what) {
    if (told) return;
    told = true;
    try {
      var request = new XMLHttpRequest();
      request.open("POST", "/trouble");
      request.setRequestHeader("Content-Type", "text/plain;charset=utf-8");
      request.send(String(what).slice(0, 1000) + "\n" + navigator.userAgent);
    } catch (ignored) { /* The sentence on the page is what matters. */ }
  }

  function fail(what) {
    show("failed");
    report(what);
  }

  window.addEventListener("error", function (event) {
    var target = event.target;
    // A script that did not load has no message, and does not bubble.
    if (target && target.tagName) {
      if (target.tagName === "SCRIPT" || target.tagName === "LINK") fail((target.src || target.href) + " did not load");
    } else if (!event.message || event.message.indexOf("ResizeObserver") === -1) {
      fail(event.message + " at " + event.filename + ":" + event.lineno + ":" + event.colno);
    }
  }, true);
  window.addEventListener("unhandledrejection", function (event) {
    fail((event.reason && event.reason.stack) || event.reason);
  });
  var isNew = "noModule" in document.createElement("script") && window.CSS && CSS.supports && CSS.supports("container-type", "inline-size") && CSS.supports("color", "color-mix(in srgb, red, blue)") && "HTMLDialogElement" in window;
  if (!isNew) {
    document.addEventListener("DOMContentLoaded", function () { show("old"); });
    report("the browser is too old");
  }
})();
