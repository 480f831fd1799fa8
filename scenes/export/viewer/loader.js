// Unpacks the modules and the data of the page and starts main.js.  A classic script: a page that is opened as a file may
// not import modules by name, so each becomes a blob in whose text the names of earlier ones are replaced.
(async () => {
  const fail = (text) => {
    const box = document.getElementById('failure');
    box.textContent = text;
    box.hidden = false;
    document.documentElement.dataset.state = 'failed';
  };
  if (typeof DecompressionStream === 'undefined')
    return fail('This page needs a browser of 2023 or later (it unpacks its data with DecompressionStream).');
  const unpack = async (element) => {
    const text = element.textContent;
    const bytes = Uint8Array.fromBase64 ? Uint8Array.fromBase64(text)
                                        : Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
    element.remove();
    return new Response(new Blob([bytes]).stream().pipeThrough(new DecompressionStream('deflate')));
  };
  try {
    const url = new Map();
    for (const element of document.querySelectorAll('script[data-module]')) {
      const source = (await (await unpack(element)).text()).replace(
        /(\bfrom\s*|\bimport\s*)(["'])([^"'\n]+)\2/g,
        (all, keyword, quote, name) => {
          const known = url.get(name.replace(/^\.\//, ''));
          return known ? keyword + quote + known + quote : all;
        });
      const blob = URL.createObjectURL(new Blob([source], {type: 'text/javascript'}));
      for (const name of element.dataset.module.split(' ')) url.set(name, blob);
    }
    const dataOf = async (id) => {
      const element = document.getElementById(id);
      return element && (await unpack(element)).arrayBuffer();
    };
    const data = await dataOf('recording'), second = await dataOf('second');
    const {start} = await import(url.get('main.js'));
    window.taut = await start(data, second);
    document.documentElement.dataset.state = 'ready';
  } catch (error) {
    console.error(error);
    fail(/WebGL/i.test(String(error)) ? 'This page needs WebGL 2, which this browser does not offer.'
                                      : 'The recording cannot be shown: ' + error.message);
  }
})();
