// The connection to the vehicle: hello, state, rows; what this page wants goes back.

const AGAIN_MS = 1000;
const HEAD_WORDS = 4; // vehicle's number, first row, rows, curves

let socket = null;

export function connect(hears) {
  const address = new URL("stream", location.href);
  address.protocol = "ws:";
  socket = new WebSocket(address);
  socket.binaryType = "arraybuffer";
  let hello = null;
  socket.onmessage = ({ data }) => {
    if (typeof data === "string") {
      const told = JSON.parse(data);
      if (told.kind === "hello") hello = told;
      hears[told.kind](told);
    } else if (hello !== null) {
      const rows = unpacked(data, hello);
      if (rows !== null) hears.rows(rows);
    }
  };
  socket.onclose = () => {
    hears.lost();
    setTimeout(() => connect(hears), AGAIN_MS);
  };
}

export function want(what) {
  if (socket !== null && socket.readyState === WebSocket.OPEN) socket.send(JSON.stringify(what));
}

function unpacked(data, hello) {
  const [number, first, count, curves] = new Uint32Array(data, 0, HEAD_WORDS);
  if (number !== hello.number) return null;
  const values = new Float32Array(data, 4 * HEAD_WORDS);
  const now = {};
  hello.shown.forEach((name, place) => {
    now[name] = values[place];
  });
  return { first, count, curves, now, samples: values.subarray(hello.shown.length) };
}
