import java.io.BufferedReader;
import java.io.InputStreamReader;
import java.io.PrintWriter;
import java.net.Socket;
import java.nio.charset.StandardCharsets;

/**
 * The keeper of the treasures as a program of 2016 would be one: it takes lines apart at fixed places and knows them by
 * the words in them.
 *
 * <p>Usage: java Hider.java HOST PORT ROOM:COLOUR:FOOTPRINT:POINTS:NAME:PICTURE... Prints what it understood, one line
 * each; ends when the server does.
 */
public final class Hider {
    private final String[][] treasures;
    private final PrintWriter out;

    private Hider(String[][] treasures, PrintWriter out) {
        this.treasures = treasures;
        this.out = out;
    }

    public static void main(String[] args) throws Exception {
        String[][] treasures = new String[100][];
        for (int i = 2; i < args.length; i++) {
            String[] fields = args[i].split(":");
            treasures[Integer.parseInt(fields[0])] = fields;
        }
        try (Socket socket = new Socket(args[0], Integer.parseInt(args[1]));
                PrintWriter out =
                        new PrintWriter(
                                new java.io.OutputStreamWriter(socket.getOutputStream(), StandardCharsets.UTF_8), true);
                BufferedReader in =
                        new BufferedReader(new InputStreamReader(socket.getInputStream(), StandardCharsets.UTF_8))) {
            Hider hider = new Hider(treasures, out);
            out.println("%%setid Hider");
            String line;
            while ((line = in.readLine()) != null) {
                hider.hear(line);
            }
        }
    }

    /** Ping before everything, acks after everything else: the order in which the old connector looked. */
    private void hear(String line) {
        if (line.contains("ping")) {
            out.println("%%pong");
        } else if (line.contains("error")) {
            tellTreasure(Integer.parseInt(line.split("\"")[1]));
        } else if (line.contains("found")) {
            String[] guess = line.split("\"")[1].split(",");
            judge(Integer.parseInt(guess[0]), guess[1]);
        } else if (line.contains("snap")) {
            String[] words = line.split(" ");
            showPicture(Integer.parseInt(words[words.length - 1]));
        } else if (line.contains("ack")) {
            System.out.println("acknowledged");
        }
    }

    private void tellTreasure(int room) {
        System.out.println("asked room=" + room);
        String senses = "(Colour: " + treasures[room][1] + ") (Footprint: " + treasures[room][2] + ")";
        out.println("%%found Hider TabUI " + room + " " + room + " \"" + senses + "\"");
    }

    private void judge(int room, String name) {
        System.out.println("identified room=" + room + " name=" + name.trim());
        int points = Integer.parseInt(treasures[room][3]);
        out.println("%%score Hider TabUI ," + (name.contains(treasures[room][4]) ? points : -points));
    }

    private void showPicture(int room) {
        System.out.println("snapped room=" + room);
        out.println("%%image Hider TabUI " + room + " " + treasures[room][5]);
    }
}
