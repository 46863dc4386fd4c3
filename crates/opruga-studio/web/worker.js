// Keeps the files of the page, so that it opens without a network. Where there is one, a new version is fetched aside and
// taken when the page is opened the next time.
const KEPT = "opruga-{{version}}";
const FILES = {{files}};

self.addEventListener("install", (event) => {
  event.waitUntil(caches.open(KEPT).then((cache) => cache.addAll(FILES)).then(() => self.skipWaiting()));
});
self.addEventListener("activate", (event) => {
  const old = (names) => names.filter((name) => name.startsWith("opruga-") && name !== KEPT);
  event.waitUntil(
    caches.keys().then((names) => Promise.all(old(names).map((name) => caches.delete(name)))).then(() => self.clients.claim()),
  );
});
self.addEventListener("fetch", (event) => {
  const { request } = event;
  if (request.method !== "GET" || new URL(request.url).origin !== location.origin) return;
  // The page itself comes from the network where there is one: it names the files of its version.
  const fresh = () => fetch(request);
  const kept = () => caches.open(KEPT).then((cache) => cache.match(request, { ignoreSearch: true }));
  event.respondWith(
    request.mode === "navigate"
      ? fresh().catch(() => kept().then((page) => page ?? caches.match("./")))
      : kept().then((file) => file ?? fresh()),
  );
});
